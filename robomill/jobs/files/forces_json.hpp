#pragma once
#include "robomill/io/json.hpp"
#include "robomill/jobs/forces.hpp"

namespace robomill::jobs {

/// forces.json as an object, for a file of its own and for plan.json.
[[nodiscard]] io::Json forces_object(const ForcesResult& result);

}  // namespace robomill::jobs
