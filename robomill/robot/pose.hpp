#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/robot/README.md, "Frames"

namespace robomill::robot {

/// Where a tool stands in the work frame W.
struct ToolPose {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();  ///< in W
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< (i, j, k), unit, from the tip to the spindle, in W
  double gamma_rad = 0.0;                           ///< turn of the flange about `axis`, which the cut does not see
};

/// The direction in W from which gamma counts: W's x axis, carried along when W's z axis turns into `axis` by the
/// shortest way. Smooth but at axis = −z, where it is −x.
/// @param axis  unit
[[nodiscard]] ROBOMILL_API Eigen::Vector3d gamma_reference(const Eigen::Vector3d& axis) noexcept;

/// Pose of the flange in B that puts the tool's tip and axis there: the flange's z is −axis, its x is gamma_reference
/// turned by gamma about the axis, its origin lies tool_length_m from the tip along the axis. Nothing is checked.
[[nodiscard]] ROBOMILL_API Eigen::Isometry3d flange_pose(const Cell& cell, const ToolPose& tool) noexcept;

/// The tool's pose in W that a pose of the flange in B makes; gamma in (−π, π].
[[nodiscard]] ROBOMILL_API ToolPose tool_pose(const Cell& cell, const Eigen::Isometry3d& flange) noexcept;

/// The tool's tip in the flange frame, (0, 0, tool_length_m).
[[nodiscard]] ROBOMILL_API Eigen::Vector3d tip_point(const Cell& cell) noexcept;

}  // namespace robomill::robot
