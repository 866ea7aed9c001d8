#pragma once
// What a controller makes of a program's joint points, and how far that is from the trajectory and from the program.
#include <array>
#include <cstddef>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/path/files/sample_spool.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/options.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// How a controller may join points in joint space.
///   line:    all joints linearly in time
///   spline:  a cubic with continuous velocity through all points; at rest where the trajectory rests
///   zone:    lines whose corners are rounded by parabolas from the middle of one to the middle of the next, the
///   largest
///            zones that a controller allows
enum class Joining { line, spline, zone };

/// One step from a point to the next with the points around it. Lengths in samples.
struct JointStep {
  std::array<robot::Position6, 4> points = {};  ///< before, from, to, after
  std::array<double, 3> lengths = {};           ///< between them; 0 before the first and after the last point
  bool from_rests = false, to_rests = false;    ///< the robot stops there
  /// The joints at a share of the step's time, in [0, 1].
  [[nodiscard]] robot::Position6 at(Joining joining, double share) const;
};

/// Points of a program: samples of the trajectory, as the controller's numbers hold them.
struct JointPoints {
  using Held = robot::Position6 (*)(const robot::Position6&);
  std::vector<std::size_t> at = {};  ///< rising sample numbers, the first and the last sample among them
  std::vector<bool> still = {};      ///< whether the trajectory stands still from point k to point k + 1
  Held held = nullptr;               ///< the number that a controller reads for a joint
  [[nodiscard]] std::size_t steps() const { return at.size() - 1; }
  [[nodiscard]] bool rests(std::size_t point) const;
  [[nodiscard]] JointStep step(SampleSpool& samples, std::size_t index) const;
};

/// Follows the points as a controller that joins them so, by forward kinematics, in at least 8 looks a step. Between
/// samples the trajectory is a cubic through four of them. The deviations bound those between the looks where the
/// motion is a parabola over the step: they are reported 1/(1 − 1/n²) larger than met with n looks.
/// @param beyond  takes true for each step that leaves a tolerance: of the trajectory or of the program
/// @throws InvalidInput what the program's reader throws; Interrupted
[[nodiscard]] RunDistances follow_points(const JointPoints& points, Joining joining, SampleSpool& samples,
                                         program::Source& program, const robot::Kinematics& machine,
                                         const SmoothingOptions& options, std::vector<bool>& beyond,
                                         const Progress& progress);

}  // namespace robomill::path
