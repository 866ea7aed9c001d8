#pragma once
#include <string>

#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation {

/// What a page shows of a simulation's columns: displacement and force over time, as the lowest and the highest value
/// of runs of equal length, and the amplitudes of the displacement about its mean in the second half of the time.
[[nodiscard]] std::string vibration_json(const Simulation& result);

}  // namespace robomill::simulation
