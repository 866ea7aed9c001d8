#pragma once
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/jobs/decide/units.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::jobs {

/// The program at the speeds and feeds that were decided. A speed holds from the rapid move on that leads to its cuts.
/// @param free_speed  else speeds stay as they are
[[nodiscard]] program::Program decided_program(const ForcesResult& forces, const ProgramUnits& units,
                                               const decision::ProgramDecision& decision, bool free_speed);

/// γ at the program's start and at each block's end: as decided along the cuts, even along the way between them.
[[nodiscard]] std::vector<double> gamma_offsets(const program::Program& program, const ProgramUnits& units,
                                                const decision::ProgramDecision& decision);

/// Joints at each block's end, turned by γ from where they are and moved to where a program with the same blocks has
/// the tip.
/// @throws InvalidInput naming block and line where the robot cannot stand so
[[nodiscard]] std::vector<robot::Position6> joints_at(const ForcesResult& forces, const program::Program& program,
                                                      const std::vector<double>& gamma_offset_rad);

}  // namespace robomill::jobs
