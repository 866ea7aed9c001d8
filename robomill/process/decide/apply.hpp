#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/process/decide/units.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::process {

/// What was decided of one stretch, as its program is made.
struct StretchConditions {
  std::optional<double> spindle_speed_rad_per_s = {};  ///< none: as programmed
  std::vector<double> slower = {};                     ///< factor on the duration of each of its lines
};

/// A program with other speeds and feeds. A speed holds from the rapid move on that leads to its cuts.
/// @param program     with the blocks that the units are of
/// @param conditions  one a stretch
[[nodiscard]] program::Program at_conditions(program::Program program, const ProgramUnits& units,
                                             const std::vector<StretchConditions>& conditions);

/// γ along a line.
struct LineGamma {
  double begin_rad = 0.0, end_rad = 0.0;
};
/// γ at the program's start and at each block's end: as decided along the lines, even along the way between them.
[[nodiscard]] std::vector<double> gamma_offsets(const program::Program& program, const ProgramUnits& units,
                                                const std::vector<LineGamma>& lines);

/// Where the robot stands along a program.
struct Stands {
  /// Where the program begins; none: there it cannot stand as it is programmed.
  std::optional<robot::Position6> start = {};
  std::vector<robot::Position6> joints = {};  ///< at each block's end, up to `lost`
  std::optional<std::size_t> lost = {};       ///< the first block in which it cannot stand so
};
/// Joints at each block's end, turned by γ from where they are and moved to where a program with the same blocks has
/// the tip and the tool's axis.
[[nodiscard]] Stands joints_at(const ForcesResult& forces, const program::Program& program,
                               const std::vector<double>& gamma_offset_rad);

}  // namespace robomill::process
