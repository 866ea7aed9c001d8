#pragma once
#include "robomill/cell/dynamics.hpp"
#include "robomill/io/json.hpp"

namespace robomill::cell {

/// What lobes.json and modes.json say of the posture that their modes are of.
[[nodiscard]] io::Json posture_object(const ModesOfPosture& posture);

}  // namespace robomill::cell
