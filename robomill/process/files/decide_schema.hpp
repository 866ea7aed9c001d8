#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/process/decide_options.hpp"

namespace robomill::process {

/// [decide]
[[nodiscard]] const io::Schema<DecideOptions>& decide_table();

}  // namespace robomill::process
