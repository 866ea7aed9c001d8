#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/path/files/smoothing_toml.hpp"

namespace robomill::path {

/// [smoothing]
[[nodiscard]] const io::Schema<SmoothingFile>& smoothing_table();

}  // namespace robomill::path
