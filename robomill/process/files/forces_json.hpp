#pragma once
#include "robomill/io/json.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

/// forces.json.
[[nodiscard]] io::Json forces_object(const ForcesResult& result);

}  // namespace robomill::process
