#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/path/files/stream_json.hpp"

namespace robomill::path {

[[nodiscard]] const io::Schema<StreamedProgram>& stream_table();

}  // namespace robomill::path
