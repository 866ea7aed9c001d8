#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/path/check.hpp"
#include "robomill/path/options.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "Method"

namespace robomill::path {

/// What became of a program.
struct Summary {
  double duration_s = 0.0;
  double lower_bound_s =
      0.0;  ///< of verified and optimal: the fastest without jerk limits on the same path; 0: not found
  std::size_t blocks = 0, samples = 0;
  int rounds = 0;         ///< plans made until the check held
  double plan_s = 0.0;    ///< processor time of planning, all rounds
  double emit_s = 0.0;    ///< … of turning the plan into samples, inverse kinematics included, last round
  double sum_t2_s = 0.0;  ///< of the FIR methods: ΣT2
  double largest_overlap_s = 0.0;
  CheckResult check = {};
};

/// Where the tool's axis leaves the program's on purpose. Places t count blocks from the program's start: block i runs
/// from i to i + 1. The tilt grows from 0 at `from` to angle_rad at `full_from`, stays until `full_to`, and is 0 at
/// `to`.
struct AxisTilt {
  double from = 0.0, full_from = 0.0, full_to = 0.0, to = 0.0;
  Eigen::Vector3d toward = Eigen::Vector3d::UnitX();  ///< unit vector in W, across the axis
  double angle_rad = 0.0;
};

/// Where a smoothed program begins and how it is turned about the tool's axis.
struct Posture {
  robot::Position6 start = robot::Position6::Zero();
  std::vector<double> gamma_rad = {};  ///< one for all, or one at the start and one at each block's end
  /// In order, without overlap; what they take of the axis' tolerance is not left to corners. The published methods
  /// know none.
  std::vector<AxisTilt> tilts = {};
  bool beside_singularity = false;  ///< taken by a machine with a larger bound of its condition number
};

/// Smooths a program. Samples of the last round go to `sink` in order; a round that breaks a limit is thrown away and
/// planned again, slower where it broke (`restart` is called before each round so that a file can begin anew).
/// @throws InvalidInput if an option is invalid, a block cannot be reached (block and line, joint, by how much), or the
/// program lasts longer than options.max_duration_s (block and line, or the limit)
[[nodiscard]] ROBOMILL_API Summary smooth(program::Source& source, const robot::Kinematics& kinematics,
                                          const Posture& posture, const SmoothingOptions& options,
                                          const SampleSink& sink, const std::function<void()>& restart,
                                          Progress& progress);

}  // namespace robomill::path
