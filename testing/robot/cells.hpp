#pragma once
// A robot cell that tests and benchmarks of collisions share.
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <vector>

#include "robomill/robot/collision.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/solids.hpp"

namespace robomill::robot::testing {

/// A KR210 before a workpiece that is turned in the robot's base frame.
inline Cell kr210_cell() {
  Cell cell{.arm = with_limits(kr210()), .tool_length_m = 0.36};
  cell.workpiece = Eigen::Translation3d(1.6, 0.1, 0.8) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  return cell;
}

/// The frame after joint k of an arm in B; 0: B.
inline Eigen::Isometry3d link_frame(const Arm& arm, int k, const Eigen::VectorXd& position) {
  if (k == 0) return Eigen::Isometry3d::Identity();
  Arm part;
  part.joints.assign(arm.joints.begin(), arm.joints.begin() + k);
  return forward(part, position.head(k));
}

/// Of every link but the last a capsule from its joint to the next.
inline std::vector<LinkBody> link_capsules(const Arm& arm, double diameter_m) {
  std::vector<LinkBody> out;
  for (int k = 0; k + 1 <= static_cast<int>(arm.size()); ++k) {
    const Eigen::Vector3d next_m = arm.joints[static_cast<std::size_t>(k)].before.translation();
    out.push_back({.link = k, .name = fmt::format("link {}", k), .capsule = Capsule{{0, 0, 0}, next_m, diameter_m}});
  }
  return out;
}

/// A flat end mill of 10 mm in a holder and a spindle.
inline ToolGeometry end_mill() {
  return {.edges = {{0.0, 5e-3}, {20e-3, 5e-3}},
          .stickout_m = 50e-3,
          .holder = {{30e-3, 30e-3, 40e-3}, {50e-3, 63e-3, 63e-3}},
          .spindle = {{0.2, 0.15, 0.15}}};
}

/// A block of 200 x 200 x 50 mm whose top is z = 0 of the work frame, on a plate, on a table.
inline CellGeometry block_on_table(const Cell& cell) {
  return {.part = {{"block", box({-0.1, -0.1, -0.05}, {0.1, 0.1, 0.0})}},
          .fixtures = {{"plate", box({-0.15, -0.15, -0.08}, {0.15, 0.15, -0.05})}},
          .cell = {{"table", box({1.0, -0.6, 0.0}, {2.2, 0.8, 0.72})}},
          .arm = link_capsules(cell.arm, 0.2),
          .tool = end_mill(),
          .clearance_m = 2e-3,
          .gouge_tolerance_m = 50e-6};
}

/// One of the positions that put the tool there. @param way  which, by its remainder
inline Eigen::VectorXd position_at(const Cell& cell, const ToolPose& pose, std::size_t way = 0) {
  const InverseSolutions found = SphericalWristInverse(cell.arm).solve(flange_pose(cell, pose));
  if (found.count == 0) return {};
  return found.solution[way % static_cast<std::size_t>(found.count)].position_rad;
}

}  // namespace robomill::robot::testing
