#pragma once
#include <string>
#include <vector>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/identify.hpp"

namespace robomill::robot {

/// How far joint 5 (or the last) of an arm comes from the first axis when it is stretched: its first offset, and the
/// distances from joint to joint after it.
/// @return 0 with fewer than two joints
[[nodiscard]] double stretched_reach_m(const Arm& arm);

/// What is unusual about the masses of an arm, a sentence each: links that all weigh the same, links that weigh too
/// little or too much together for the arm's reach, and a moment of inertia that does not go with its link's mass.
/// Nothing of an arm without masses.
///
/// The moving mass is compared with 5 to 150 kg/m^3 of the reach cubed, from 1.3 m on, and with 5 to 300 kg/m^3 below;
/// what makers' arms have is in robot/README.md.
[[nodiscard]] std::vector<std::string> unusual_masses(const Arm& arm);

/// What is unusual about measured displacements: that they go against their loads, or how stiff the arm would be at the
/// point. By estimate arms have 0.1 to 10 N/µm there; 0.02 to 50 N/µm passes.
[[nodiscard]] std::vector<std::string> unusual_displacements(const std::vector<Load>& loads);

}  // namespace robomill::robot
