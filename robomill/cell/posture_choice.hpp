#pragma once
#include <array>
#include <string>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/path/posture.hpp"

// Method: robomill/path/README.md, "Posture"

namespace robomill::cell {

/// Where the cell says that the machine begins; else joints at 0, or in the middle of limits that 0 is not within.
[[nodiscard]] robot::Position6 home_of(const Cell& cell, const robot::Kinematics& machine);

/// How the cell's posture before a program is chosen: near home, with the γ and the start that it gives.
[[nodiscard]] path::PostureOptions posture_options(const Cell& cell, const robot::Kinematics& machine);

/// Puts a posture in the place of robot.start_joints_deg, and nearness to it before margin.
/// @param joints_deg  a value a joint
/// @throws InvalidInput of --posture if the machine has other joints or a value is not within its limits
void ask_for_posture(Cell& cell, const std::vector<double>& joints_deg);

/// "-2, -77, 91, 45, 85, -105°; shoulder, elbow and wrist as at home": where the program starts.
[[nodiscard]] std::string posture_text(const path::PostureChoice& choice, int joints,
                                       const std::array<bool, 6>& prismatic);

/// What is worth a remark: whole turns, another configuration than home's, a singularity that is passed closely.
[[nodiscard]] std::vector<std::string> posture_notes(const path::PostureChoice& choice);

}  // namespace robomill::cell
