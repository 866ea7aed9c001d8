#pragma once
#include <cstddef>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "Posture"

namespace robomill::path {

struct ROBOMILL_API PostureOptions {
  std::optional<double> gamma_rad = {};        ///< fixed; not given: free to choose
  std::optional<robot::Position6> start = {};  ///< near which the machine begins; not given: any way
  bool free_gamma = false;                     ///< gamma may turn along the way even where a constant one would do
  int gammas = 72;                             ///< >= 4; tried in a full turn
  double max_axis_step_rad = 0.035;  ///< > 0; between two looks along the program: turn of the axis <= this …
  double max_tip_step_m = 0.005;     ///< > 0; … and way of the tip <= this
  std::size_t max_blocks = 20'000;   ///< >= 1; a longer program is judged by its first so many
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// How near a way comes to where it cannot go on: the least of the distance to a joint's limit, as a share of half its
/// range, and of Kinematics::regularity.
struct Margin {
  double least = 1.0;
  std::size_t block = 0;  ///< where, from 0
  int joint = -1;         ///< whose limit; -1: a singularity is nearer
};

/// Where the machine starts, and what was found out about it.
struct PostureChoice {
  Posture posture = {};
  Margin margin = {};
  std::size_t blocks = 0;  ///< looked at
  bool whole = true;       ///< they are all
};

/// Chooses where a machine starts and how the flange stands about the tool's axis: of all constant gammas and all ways
/// to the first pose the one that goes through with the largest margin; where no constant gamma does, gamma turns from
/// block to block. The program is looked at in steps, finer near a singularity and wherever a joint moves far.
/// @throws InvalidInput if an option is invalid, or no way goes through: the block (from 1) where the one that gets
///     farthest ends, its line, joint and amount; or that the start cannot be taken
[[nodiscard]] ROBOMILL_API PostureChoice choose_posture(program::Source& source, const robot::Kinematics& kinematics,
                                                        const PostureOptions& options = {});

/// The error for a pose that cannot be taken.
/// @param block  from 0
/// @param line   in the program's file; 0: the pose is the program's start
[[nodiscard]] ROBOMILL_API InvalidInput cannot_take(const robot::Reach& reach, const robot::Kinematics& kinematics,
                                                    std::size_t block, std::size_t line);

}  // namespace robomill::path
