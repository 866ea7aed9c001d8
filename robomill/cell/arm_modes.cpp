#include "robomill/cell/arm_modes.hpp"

#include <algorithm>
#include <utility>

#include "robomill/modal/tip.hpp"
#include "robomill/robot/joint_load.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::cell {

std::optional<robot::Link> payload_of(const Cell& cell) {
  if (!cell.end_effector.mass_kg) return std::nullopt;
  constexpr double radius_of_gyration_m = 0.1;
  const Eigen::Isometry3d flange = cell.robot.arm.flange * cell.mount().inverse();  // after the last joint
  robot::Link link;
  link.mass_kg = *cell.end_effector.mass_kg;
  link.center_m = flange * cell.end_effector.center();
  link.inertia_kg_m2 = link.mass_kg * radius_of_gyration_m * radius_of_gyration_m * Eigen::Matrix3d::Identity();
  return link;
}

robot::Arm loaded_arm(const Cell& cell) {
  const std::optional<robot::Link> payload = payload_of(cell);
  return payload ? robot::with_payload(cell.robot.arm, *payload) : cell.robot.arm;
}

bool vibrates(const robot::Arm& arm) {
  return std::ranges::any_of(arm.joints, [](const robot::Joint& j) { return j.link.mass_kg > 0.0; }) &&
         std::ranges::all_of(arm.joints, [](const robot::Joint& j) { return j.damping > 0.0; });
}

modal::ModalModel arm_modes(const robot::Cell& cell, const Eigen::VectorXd& joints, robot::Inertia inertia) {
  const robot::ToolModes found = robot::tool_modes(cell.arm, joints, robot::tip_point(cell), inertia);
  modal::ModalModel model;
  model.excitations = model.responses = modal::tip_axes();
  model.modes.reserve(found.modes.size());
  for (const robot::ToolMode& swing : found.modes) {
    modal::Mode mode;
    mode.frequency_hz = swing.frequency_hz;
    mode.damping_ratio = swing.damping_ratio;
    mode.right = swing.right.head<3>();
    mode.left = swing.left.head<3>();
    model.modes.push_back(std::move(mode));
  }
  return model;
}

}  // namespace robomill::cell
