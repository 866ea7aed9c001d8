#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/report/fact.hpp"

// Method: robomill/report/README.md, "Method"

/// The forces of a cut as a part of the report. Frames and angles are those of docs/frames.md: rotation counts
/// clockwise from +y of the feed frame, seen from the spindle.
namespace robomill::report {

/// From where to where a tooth is in the material.
struct EngagementArc {
  double entry_rad = missing;
  double exit_rad = missing;  ///< >= entry_rad; beyond 2π where the arc runs over +y
};

/// A ring of the cutter and its arcs in the material.
struct EngagementRing {
  double height_m = missing;             ///< along the cutter's axis, from the tip
  double position_rad = missing;         ///< κ, between the axis and the edge's normal: 0 at the tip of a ball
  std::vector<EngagementArc> arcs = {};  ///< empty: this ring cuts nothing
};

/// Force and torque over the cutter's rotation in one place of the cut.
struct ForceRevolution {
  Eigen::VectorXd rotation_rad = {};  ///< length n, increasing; one turn, or more where the simulation ran on
  Eigen::Matrix3Xd force_n = {};      ///< 3 x n, feed frame, on the tool
  bool on_workpiece = false;          ///< the forces are those on the workpiece instead
  Eigen::VectorXd torque_n_m = {};    ///< length n, that the spindle must give
  Eigen::Vector3d mean_n = Eigen::Vector3d::Constant(missing);
  Eigen::Vector3d peak_n = Eigen::Vector3d::Constant(missing);  ///< largest in magnitude
  Eigen::Vector3d rms_n = Eigen::Vector3d::Constant(missing);
  double mean_torque_n_m = missing, peak_torque_n_m = missing;
  double power_w = missing;       ///< mean
  double chip_area_m2 = missing;  ///< across the feed: removal rate / feed speed
  double removal_rate_m3_per_s = missing;
  std::vector<EngagementRing> engagement = {};  ///< height increasing

  Eigen::Vector3d deflection_m = Eigen::Vector3d::Constant(missing);  ///< by the mean force, feed frame; missing: rigid
  double peak_deflection_m = missing;
  bool vibrating = false;    ///< from the time-domain simulation
  std::string verdict = {};  ///< what that simulation says, in plain words
  double chatter_frequency_hz = missing;
};

/// Forces along a program: every vector has one value a block. Work frame.
struct ForcePath {
  Eigen::VectorXd block = {}, line = {};  ///< number of the block, line of the file; whole, >= 0
  Eigen::Matrix3Xd tip_m = {};            ///< 3 x n, the tool's tip at the block's end; finite
  Eigen::VectorXd path_m = {};            ///< length run to the block's end, never decreasing
  Eigen::VectorXd time_s = {};            ///< time run to the block's end, never decreasing; may be empty
  Eigen::VectorXd axial_depth_m = {}, radial_depth_m = {};
  Eigen::VectorXd peak_force_n = {};                           ///< magnitude
  Eigen::Matrix3Xd mean_force_n = {};                          ///< 3 x n, while cutting
  Eigen::VectorXd torque_n_m = {};                             ///< largest mean over one revolution
  Eigen::VectorXd peak_torque_n_m = {};                        ///< largest at any rotation
  Eigen::VectorXd power_w = {};                                ///< largest mean over power_time_s
  double power_time_s = 0.1;                                   ///< > 0
  Eigen::VectorXd deflection_m = {};                           ///< largest magnitude; empty where nothing bends
  std::vector<bool> cuts = {};                                 ///< false: a rapid move or a move in air
  std::vector<std::string> troubles = {};                      ///< "part.ngc:212: out of reach"
  double torque_limit_n_m = missing, power_limit_w = missing;  ///< of the spindle, > 0
};

/// How far the force bends the robot, over the redundant rotation about the spindle's axis.
struct RedundancySweep {
  Eigen::VectorXd rotation_rad = {};      ///< γ, length n, increasing
  Eigen::VectorXd deflection_m = {};      ///< length n; NaN: the robot cannot stand so
  Eigen::VectorXd condition_number = {};  ///< of the Jacobian, length n; may be empty
  double best_rad = missing, used_rad = missing;
};

/// Forces of one place in the cut, along a program, or both.
struct Forces {
  std::vector<Fact> facts = {};
  std::vector<std::string> warnings = {}, notes = {};
  std::optional<ForceRevolution> revolution = {};
  std::optional<ForcePath> path = {};
  std::optional<RedundancySweep> spindle_rotation = {};

  /// @throws InvalidInput naming the member ("path.tip_m") if lengths do not match, an axis does not increase, a
  /// required number is missing, or a number is infinite
  ROBOMILL_API void validate() const;
};

}  // namespace robomill::report
