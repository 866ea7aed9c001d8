#pragma once
#include "robomill/io/json.hpp"
#include "robomill/path/files/smooth_json.hpp"

namespace robomill::path {

/// smooth.json, for a file of its own and for plan.json. @throws InvalidInput if there is no method
[[nodiscard]] io::Json smooth_object(const SmoothedProgram& smoothed);

}  // namespace robomill::path
