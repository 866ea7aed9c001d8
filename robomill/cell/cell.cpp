#include "robomill/cell/cell.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/serial_kinematics.hpp"

namespace robomill::cell {

program::ProgramReading program_reading(const Cell& cell) {
  program::ProgramReading reading = {.rotary = cell.rotary, .tool = cell.tool_choice, .frames = cell.program_frames};
  if (!cell.machine.empty()) reading.machine = program::parse_machine(cell.machine);
  return reading;
}

std::unique_ptr<robot::Kinematics> kinematics(const Cell& cell, double max_condition_number) {
  if (cell.hybrid) return std::make_unique<robot::HybridKinematics>(*cell.hybrid);
  try {
    robot::SerialOptions options;
    options.singularity.max_condition_number = max_condition_number;
    return std::make_unique<robot::SerialKinematics>(cell.robot, options);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = cell.path.string();
    parts.field = "robot";
    throw InvalidInput(std::move(parts));
  }
}

std::vector<Assumption> assumed_along_program(const Cell& cell, bool gamma_chosen) {
  std::vector<Assumption> out;
  const auto add = [&](std::string what, std::string taken, std::string key) {
    if (cell.path.empty()) return;
    out.push_back({.what = std::move(what),
                   .taken = std::move(taken),
                   .key = std::move(key),
                   .file = cell.path.filename().string()});
  };
  std::string open;
  constexpr double without_limit = 1e299;
  for (std::size_t i = 0; i < cell.robot.arm.joints.size(); ++i) {
    const robot::Joint& joint = cell.robot.arm.joints[i];
    if (joint.min_position > -without_limit && joint.max_position < without_limit) continue;
    open += fmt::format("{}{}", open.empty() ? "" : ", ", i + 1);
  }
  if (!open.empty()) add("Limits of the positions of joints " + open, "none", "robot.joint_min_position_deg");
  if (!cell.hybrid && !cell.gamma_given && !gamma_chosen) {
    add("Turn of the flange about the tool's axis", "0°", "robot.gamma_deg");
  }
  add_assumed(out, cell.assumed);
  return out;
}

}  // namespace robomill::cell
