#include "robomill/robot/pose.hpp"

#include <cmath>

namespace robomill::robot {

Eigen::Vector3d gamma_reference(const Eigen::Vector3d& axis) noexcept {
  const double i = axis.x(), j = axis.y(), k = axis.z();
  // 1 + k, of a unit vector, without cancellation.
  const double below = k < 0.0 ? (i * i + j * j) / (1.0 - k) : 1.0 + k;
  if (below == 0.0) return -Eigen::Vector3d::UnitX();
  // 1 + [v] + [v]² / (1 + k) with v = z × axis, applied to x.
  return {1.0 - i * i / below, -i * j / below, -i};
}

Eigen::Isometry3d flange_pose(const Cell& cell, const ToolPose& tool) noexcept {
  const Eigen::Vector3d from = gamma_reference(tool.axis);
  const Eigen::Vector3d x = std::cos(tool.gamma_rad) * from + std::sin(tool.gamma_rad) * tool.axis.cross(from);
  Eigen::Isometry3d in_w = Eigen::Isometry3d::Identity();
  in_w.linear() << x, x.cross(tool.axis), -tool.axis;
  in_w.translation() = tool.tip_m + cell.tool_length_m * tool.axis;
  return cell.workpiece * in_w;
}

ToolPose tool_pose(const Cell& cell, const Eigen::Isometry3d& flange) noexcept {
  const Eigen::Isometry3d in_w = cell.workpiece.inverse() * flange;
  ToolPose out{.tip_m = in_w * tip_point(cell), .axis = -in_w.linear().col(2)};
  const Eigen::Vector3d from = gamma_reference(out.axis), x = in_w.linear().col(0);
  out.gamma_rad = std::atan2(out.axis.cross(from).dot(x), from.dot(x));
  return out;
}

Eigen::Vector3d tip_point(const Cell& cell) noexcept {
  return {0.0, 0.0, cell.tool_length_m};
}

}  // namespace robomill::robot
