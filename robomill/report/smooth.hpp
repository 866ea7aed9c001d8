#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/report/fact.hpp"
#include "robomill/signal/bands.hpp"

// Method: robomill/report/README.md, "Method"

/// A smoothed program as a part of the report. Work frame.
namespace robomill::report {

/// What one joint does; rad or m.
struct JointMotion {
  bool prismatic = false;  ///< m; else rad
  signal::Band velocity = {}, acceleration = {}, jerk = {};
  signal::Band tracking_error = {};  ///< of its drive; empty where none was modelled
  double max_velocity = missing, max_acceleration = missing, max_jerk = missing;  ///< limits, > 0
};

/// A trajectory over time: every band has n runs of run_s each, from 0 on.
struct Motion {
  double run_s = missing;
  signal::Band tip_speed_m_per_s = {}, axis_speed_rad_per_s = {};
  std::vector<JointMotion> joints = {};
  Eigen::Matrix3Xd tip_m = {};                ///< 3 x m, some of its points in their order
  Eigen::VectorXd tip_speed_at_m_per_s = {};  ///< length m
};

/// One limit and how near a trajectory came to it.
struct LimitUse {
  enum class Quantity { length, angle, share };
  std::string what = {};  ///< "joint 3, jerk"
  Quantity quantity = Quantity::length;
  int order = 0;           ///< derivatives by time, 0 to 3
  double max = missing;    ///< SI
  double limit = missing;  ///< SI; missing: none given
  std::size_t violations = 0;
  double at_s = missing;
  std::size_t block = 0;  ///< from 1; 0: unknown
};

/// One method's trajectory.
struct SmoothMethod {
  std::string name = {};  ///< "verified"
  double duration_s = missing;
  double lower_bound_s = missing;
  double sum_t2_s = missing;
  double plan_s = missing;    ///< to plan
  double sample_s = missing;  ///< to make one sample
  std::size_t samples = 0;
  int rounds = 0;
  double tip_error_m = missing, axis_error_rad = missing;
  double joint_share = missing;         ///< the most of a joint's velocity, acceleration or jerk limit that is used
  double tracking_error_rad = missing;  ///< the largest of a joint that turns
  double tracking_error_m = missing;    ///< … and of one that slides
  std::vector<LimitUse> uses = {};
  Motion motion = {};
};

/// A corner of the program seen close, in the plane of its two moves: x along the way, y to the inside.
struct CornerView {
  std::size_t block = 0, line = 0;  ///< of the move into the corner, from 1
  double turn_rad = missing;
  double radius_m = missing;                 ///< half the view's width, > 0
  Eigen::Matrix2Xd program_m = {};           ///< 2 x n, corner at 0
  std::vector<Eigen::Matrix2Xd> tip_m = {};  ///< one a method; 2 x any
};

struct Smooth {
  std::vector<Fact> facts = {};
  std::vector<std::string> warnings = {}, notes = {};
  std::vector<std::string> skipped = {};  ///< "line 7: M8"
  double tip_tolerance_m = missing;       ///< > 0
  double max_tip_speed_m_per_s = missing, max_axis_speed_rad_per_s = missing;
  std::size_t blocks = 0;
  Eigen::Matrix3Xd program_m = {};         ///< 3 x n, the programmed path; some of its points where it is long
  std::vector<SmoothMethod> methods = {};  ///< the first is the one asked for
  std::vector<CornerView> corners = {};

  /// @throws InvalidInput naming the member ("methods[0].motion.run_s") if there is no method, lengths do not match,
  /// or a number is infinite
  ROBOMILL_API void validate() const;
};

}  // namespace robomill::report
