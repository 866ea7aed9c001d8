#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "The proof"

namespace robomill::path {

/// One limit and how near the trajectory came to it.
struct Usage {
  double max = 0.0;            ///< the largest magnitude met
  double limit = 0.0;          ///< 0: not given
  std::size_t violations = 0;  ///< samples with magnitude > limit · (1 + CheckOptions::relative_tolerance)
  double at_s = 0.0;           ///< when the largest was met
  std::size_t block = 0;       ///< … and in which block
};

/// Of the path that one violation stands for: 0.2 mm a cell.
inline constexpr double violation_cells_per_m = 5000.0;

/// Samples that break a limit, reported so that a planner can correct them.
struct Violation {
  std::size_t block = 0;
  double time_s = 0.0;
  double path_m = 0.0;  ///< Sample::path_m
  double ratio = 1.0;   ///< of what was met to the limit
  int order = 1;  ///< 0: tolerance; 1, 2, 3: velocity, acceleration, jerk; −1: what neither a narrower nor a slower
                  ///< path corrects (faulty samples, positions beyond joint limits, poses, dwells)
};

/// What a trajectory does, found from its samples alone.
struct CheckResult {
  struct Joint {
    Usage position;  ///< max: the most beyond its limits, <= 0 within
    Usage velocity, acceleration, jerk;
  };
  std::vector<Joint> joints = {};
  Usage tip_velocity, tip_acceleration, tip_jerk;     ///< m/s, m/s², m/s³ along the path
  Usage axis_velocity, axis_acceleration, axis_jerk;  ///< rad/s … along the path
  Usage feed;                                         ///< tip speed over the programmed one; limit 1
  Usage tip_error_m, axis_error_rad;
  Usage synchrony_rad;  ///< angle between the axis and the one programmed where the tip is; no limit
  Usage pose_error;     ///< m and rad; of the joints' forward kinematics against the samples' own tip and axis
  Usage dwell_s;        ///< by how much a dwell stood still too short; limit: two periods, what sampling hides
  /// Samples that are not finite (or beyond 1e9 m or rad), name no block of the program, or are off the sample grid:
  /// |time - due| > 1e-6 · period + 1e-12 · |due|.
  std::size_t faulty = 0;
  std::size_t samples = 0;
  double duration_s = 0.0;
  std::vector<Violation> worst_violations =
      {};  ///< the worst of each order, block and 0.2 mm of its path, in order of time; at most 100,000
  [[nodiscard]] ROBOMILL_API std::size_t violations() const;  ///< of all, faulty samples too
};

struct ROBOMILL_API CheckOptions {
  /// >= 0; a violation is a value > limit · (1 + relative_tolerance): rounding of differences. No such slack for joint
  /// positions.
  double relative_tolerance = 1e-6;
  /// > 0 [m and rad]; a violation where max(|Δtip|, |Δaxis|) > max_pose_error · (1 + relative_tolerance).
  double max_pose_error = 1e-7;
  /// Velocity, acceleration, jerk, feed and dwells have no limit; errors of tip and axis, joint positions and poses are
  /// held to theirs all the same.
  bool tolerances_alone = false;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Checks a trajectory by finite differences of its samples, block by block against its program; shares no code with
/// the planners. With period h: velocity (x_i − x_{i−1})/h, acceleration and jerk its second and third differences;
/// speed along the path |v_i|, its rate (|v_i| − |v_{i−1}|)/h, and the third difference's projection on the velocity
/// in its middle, v_{i−1}; of the axis with the rotation from one sample to the next as its step. Before the first
/// sample and after the last one everything stands still, and these differences count too. A difference is of the block
/// and the time in its middle.
///
/// Feed: |v_i| against the largest programmed feed of the blocks that it spans; a rapid has none. Where no tip is
/// programmed to move, the feed is that of the moving neighbours, and the axis is held to its programmed angular speed
/// or theirs. Tip and axis error: from each sample to the nearest of the blocks around the one it names (8 to each
/// side; 64 where that is beyond the tolerance), and from each programmed corner, start and end to the nearest chord
/// between samples around it. Errors below a thousandth of their tolerance may be reported too large, misses of a
/// corner by over four tolerances up to twice too large. A sample that is not finite is taken as standing still.
///
/// Memory is bounded by the program's blocks near the tool (1,024).
class ROBOMILL_API Checker {
 public:
  /// @param source  the program, read along with the samples from its beginning; outlives the checker, as the machine
  /// @throws InvalidInput if the options are invalid
  Checker(program::Source& source, const robot::Kinematics& kinematics, const SmoothingOptions& options,
          const CheckOptions& check = {});
  ~Checker();
  Checker(const Checker&) = delete;
  Checker& operator=(const Checker&) = delete;
  Checker(Checker&&) = delete;
  Checker& operator=(Checker&&) = delete;
  void add(std::span<const Sample> samples);
  /// Ends the trajectory: at rest, at the program's end.
  [[nodiscard]] CheckResult finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robomill::path
