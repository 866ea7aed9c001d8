#include "robomill/cell/files/cell_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/arm_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/robot/files/geometry_toml.hpp"
#include "robomill/robot/files/joint_limits.hpp"
#include "robomill/robot/usual_arm.hpp"

namespace robomill::cell {
namespace {

/// Where each of joint_limits goes, of the hybrid machine.
constexpr std::array<robot::Position6 robot::JointLimits::*, robot::joint_limits.size()> of_hybrid = {
    &robot::JointLimits::min_position, &robot::JointLimits::max_position, &robot::JointLimits::max_velocity,
    &robot::JointLimits::max_acceleration, &robot::JointLimits::max_jerk};

void require_usable(const io::TomlFile& file, RobotKind kind, Robots usable) {
  if (kind == RobotKind::serial || usable == Robots::any) return;
  throw file.reject("robot.kind", "is a hybrid machine; this needs a serial arm",
                    "Forces and stiffness at the joints are known of serial arms alone; robomill smooth takes both");
}

/// Of a posture: angles within the limits.
void check_joints(const io::TomlFile& file, const std::string& key, const robot::Arm& arm,
                  const std::vector<double>& angles) {
  if (angles.size() != arm.joints.size()) {
    throw file.reject(key,
                      fmt::format("must hold one value a joint, {}; it holds {}", arm.joints.size(), angles.size()));
  }
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const robot::Joint& joint = arm.joints[i];
    if (joint.prismatic) throw file.reject(key, fmt::format("must be angles; joint {} is prismatic", i + 1));
    if (angles[i] >= joint.min_position && angles[i] <= joint.max_position) continue;
    throw file.reject(key, fmt::format("must lie within the limits; joint {} has {:.6g} to {:.6g} deg", i + 1,
                                       joint.min_position / units::deg, joint.max_position / units::deg));
  }
}

constexpr std::size_t hybrid_joints = 5;  // q1, q2, q3 the legs, q4, q5 the slides

void take_hybrid(io::TomlFile& file, const RobotTable& given, Cell& out) {
  const auto reject = [&file](const std::string& key) {
    if (file.has(key)) throw file.reject(key, "goes with kind = \"serial\"");
  };
  for (const char* key : {"robot.model", "robot.dh", "robot.urdf", "robot.urdf_tip", "robot.urdf_base",
                          "robot.base_origin_mm", "robot.base_rotation_deg", "robot.links", "robot.start_joints_deg",
                          "robot.gamma_deg", "tool.mount_origin_mm", "tool.mount_rotation_deg", "geometry"}) {
    reject(key);
  }
  for (const JointList& list : joint_lists) reject(std::string("robot.") + list.key);
  robot::HybridMachine& machine = out.hybrid.emplace(given.machine);
  const std::vector<bool> prismatic(hybrid_joints, true);
  for (std::size_t k = 0; k < robot::joint_limits.size(); ++k) {
    const auto values = robot::read_joint_limit(file, robot::joint_limits[k], prismatic, out.notes);
    for (std::size_t i = 0; i < values.size(); ++i) {
      double& value = (machine.limits.*of_hybrid[k])(static_cast<Eigen::Index>(i));
      value = values[i].value_or(value);
    }
  }
}

/// @return as take_arm
std::vector<Eigen::Isometry3d> take_serial(io::TomlFile& file, const RobotTable& given, const Eigen::Isometry3d& mount,
                                           Cell& out) {
  for (const io::Row<robot::HybridMachine>& size : hybrid_rows()) {
    const std::string key = "robot." + size.key.name;
    if (file.has(key)) throw file.reject(key, "goes with kind = \"hybrid-2upr-rpu\"");
  }
  std::vector<Eigen::Isometry3d> link_frames = take_arm(file, given, mount, out);
  if (file.has("robot.start_joints_deg")) {
    check_joints(file, "robot.start_joints_deg", out.robot.arm, given.start_joints);
    out.home = out.start_joints = given.start_joints;
  }
  out.gamma_given = given.gamma_rad.has_value();
  out.redundant_gamma_rad = given.gamma_rad.value_or(out.redundant_gamma_rad);
  return link_frames;
}

/// Where the dynamics were measured, and what holds them.
void read_postures(io::TomlFile& file, Cell& out) {
  for (std::size_t i = 0; i < file.tables("postures"); ++i) {
    const std::string row = fmt::format("postures[{}]", i);
    PostureEntry& entry = out.postures.emplace_back();
    measured_posture_table().read(file, row, entry, fmt::format("postures[{}].", i + 1));
    check_joints(file, row + ".joints_deg", out.robot.arm, entry.joints);
    if (entry.frf.empty() == entry.modes.empty()) {
      file.require(row + ".frf", "FRFs of the tool's tip in that posture; or modes");
      throw file.reject(row + ".frf", "must not stand beside modes");
    }
  }
}

/// @return the spindle frame in the flange frame
Eigen::Isometry3d read_tool(io::TomlFile& file, Cell& out) {
  MountedTool tool;
  mounted_tool_table().read(file, "tool", tool);
  if (tool.end.center_m && !tool.end.mass_kg) throw file.reject("tool.center_mm", "goes with tool.mass_kg");
  spindle_outputs_table().read(file, "spindle", tool.end);
  Eigen::Isometry3d mount = tool.mount.pose();
  tool.end.tip = mount;
  tool.end.tip.translate(tool.length_m * Eigen::Vector3d::UnitZ());
  out.length_given = file.has("tool.length_mm");
  out.robot.tool_length_m = tool.length_m;
  out.end_effector = std::move(tool.end);
  return mount;
}

}  // namespace

CellFile read_cell(const io::TomlSource& source, Robots usable) {
  CellFile out;
  out.document = std::make_shared<io::TomlFile>(source);
  io::TomlFile& file = *out.document;
  out.path = file.file_of_part("job.cell", "robot");
  file.skip("smoothing");
  file.require("robot", "Write [robot] with the arm: model, or dh, or urdf");
  RobotTable given;
  robot_table().read(file, "robot", given);
  require_usable(file, given.kind, usable);
  const bool serial = given.kind == RobotKind::serial;
  if (!serial) take_hybrid(file, given, out);
  const Eigen::Isometry3d mount = read_tool(file, out);
  std::vector<Eigen::Isometry3d> link_frames;
  if (serial) link_frames = take_serial(file, given, mount, out);
  take_origin(given, out);
  if (file.has("workpiece")) file.require("workpiece.origin_mm");
  if (file.has("tool") && !file.has("tool.teeth")) file.require("tool.length_mm");  // else [tool] may be the cutter's
  out.origin_given = file.has("workpiece.origin_mm");
  robot::Placement workpiece;
  workpiece_table().read(file, "workpiece", workpiece);
  out.robot.workpiece = workpiece.pose();
  program_words_table().read(file, "program", out);
  if (!out.hybrid) {
    read_postures(file, out);
    out.geometry = robot::read_geometry(file, out.robot, out.mount(), link_frames, out.notes);
  }
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  file.locate([&] { program_reading(out).validate(); });
  add_assumed(out.assumed, io::sample_values(file));
  for (const std::string& text : robot::unusual_masses(out.robot.arm))
    out.notes.push_back(fmt::format("{}{}: {}", io::warning_label, out.path.string(), text));
  if (out.hybrid) {
    out.hybrid->workpiece = out.robot.workpiece;
    out.hybrid->tool_length_m = out.robot.tool_length_m;
    file.locate([&] { out.hybrid->validate(); });
  } else {
    file.locate([&] { out.robot.validate(); });
  }
  return out;
}

}  // namespace robomill::cell
