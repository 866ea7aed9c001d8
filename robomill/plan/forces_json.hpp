#pragma once
#include "robomill/formats/json.hpp"
#include "robomill/plan/forces.hpp"

namespace robomill::plan {

/// forces.json as an object, for a file of its own and for plan.json.
[[nodiscard]] formats::Json forces_object(const ForcesResult& result);

}  // namespace robomill::plan
