#pragma once
#include "robomill/io/json.hpp"
#include "robomill/jobs/posture.hpp"

namespace robomill::jobs {

/// What lobes.json and modes.json say of the posture that their modes are of.
[[nodiscard]] io::Json posture_object(const ModesOfPosture& posture);

}  // namespace robomill::jobs
