#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "Posture"

namespace robomill::path {

struct ROBOMILL_API PostureOptions {
  std::optional<double> gamma_rad = {};        ///< fixed; not given: free to choose
  std::optional<robot::Position6> start = {};  ///< near which the machine begins; not given: any way
  /// Joints that the machine should resemble: of the ways that go through well, one with this configuration of
  /// shoulder, elbow and wrist, few whole turns and little way from here. Not given: the largest margin alone counts
  std::optional<robot::Position6> home = {};
  bool home_asked = false;        ///< it is no home but where the user wants to begin: see Resemblance::asked
  double margin_for_home = 0.25;  ///< in [0, 1]; share of the largest margin that may be given up for nearness to home
  bool free_gamma = false;        ///< gamma may turn along the way even where a constant one would do
  int gammas = 72;                ///< >= 4; tried in a full turn
  double max_axis_step_rad = 0.035;  ///< > 0; between two looks along the program: turn of the axis <= this …
  double max_tip_step_m = 0.005;     ///< > 0; … and way of the tip <= this
  std::size_t max_blocks = 20'000;   ///< >= 1; a longer program is judged by its first so many
  /// What may pass beside a singularity of the wrist through which every way leads: the same machine with a larger
  /// bound of its condition number, and by how much the axis may leave the program's there. Null: nothing.
  const robot::Kinematics* beside = nullptr;
  double max_axis_tilt_rad = 0.0;  ///< in [0, most_tilt_rad]
  static constexpr double most_tilt_rad = 0.1;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// How near a way comes to where it cannot go on: the least of the distance to a joint's limit, as a share of half its
/// range, and of Kinematics::regularity.
struct Margin {
  double least = 1.0;
  std::size_t block = 0;                                 ///< where, from 0
  int joint = -1;                                        ///< whose limit; -1: a singularity is nearer
  robot::Position6 position = robot::Position6::Zero();  ///< there
};

/// How a position stands to home.
struct Resemblance {
  bool asked = false;                                ///< to a posture that was asked for, in home's place
  bool known = false;                                ///< the configurations of both are
  bool shoulder = true, elbow = true, wrist = true;  ///< as at home; true where home stands between two ways
  int turns = 0;                                     ///< whole turns of all joints that bring them nearer to home
  double distance = 0.0;                             ///< √ Σ (way of a joint from home / half its range)²
};

/// Where the machine starts, and what was found out about it.
struct PostureChoice {
  Posture posture = {};
  Margin margin = {};
  std::size_t blocks = 0;                       ///< looked at
  std::optional<Resemblance> resemblance = {};  ///< of the start to home, where home is given
  robot::Configuration at_margin = {};          ///< where the margin is least
  bool in_line = false;                         ///< turns_last_joint_alone() of the machine
  bool whole = true;                            ///< they are all
};

/// A position that resembles home, where the way from it moves joints between low and high.
[[nodiscard]] ROBOMILL_API Resemblance resemblance(const robot::Kinematics& kinematics, const robot::Position6& home,
                                                   const robot::Position6& start, const robot::Position6& low,
                                                   const robot::Position6& high);

/// What a position stands next to: "axes 4 and 6 stand 0.31° from one line", "the arm stands 2° from stretched or
/// folded", "the wrist's centre stands 12 mm from axis 1", and their like where axes 2, 3 and 4 are parallel; empty
/// from 5° or 50 mm on.
[[nodiscard]] ROBOMILL_API std::string singularity_text(const robot::Configuration& configuration);

/// Whether a turn about the tool's axis moves the last joint and no other: the spindle stands in line with the flange,
/// and turning the flange leads away from no singularity and from no limit of another joint.
[[nodiscard]] ROBOMILL_API bool turns_last_joint_alone(const robot::Kinematics& kinematics);

/// Chooses where a machine starts and how the flange is turned about the tool's axis, of all constant gammas and all
/// ways to the first pose that go through with a margin of 0.05; where none has that much, with half of the largest
/// margin there is. Of them those with home's shoulder, elbow and wrist come first, in this order, then those with the
/// fewest whole turns away from home, then the one nearest to home, for which margin_for_home of the largest margin of
/// its kind is given up at most. Without home the largest margin decides. Where no constant gamma goes through, gamma
/// turns from block to block. Where that does not go through a singularity of the wrist either, the axis is tilted
/// there by max_axis_tilt_rad. The program is looked at in steps, finer near a singularity and wherever a joint moves
/// far.
/// @throws Interrupted
/// @throws InvalidInput if an option is invalid, or no way goes through: the block (from 1) where the one that gets
///     farthest ends, its line, joint and amount; or that the start cannot be taken
[[nodiscard]] ROBOMILL_API PostureChoice choose_posture(program::Source& source, const robot::Kinematics& kinematics,
                                                        const PostureOptions& options = {},
                                                        Progress& progress = Progress::none());

/// The error for a pose that cannot be taken.
/// @param block  from 0
/// @param line   in the program's file; 0: the pose is the program's start
[[nodiscard]] ROBOMILL_API InvalidInput cannot_take(const robot::Reach& reach, const robot::Kinematics& kinematics,
                                                    std::size_t block, std::size_t line);

}  // namespace robomill::path
