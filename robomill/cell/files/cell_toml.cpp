#include "robomill/cell/files/cell_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/arm_toml.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/files/geometry_toml.hpp"
#include "robomill/robot/files/joint_limits.hpp"
#include "robomill/robot/files/pose_toml.hpp"
#include "robomill/robot/usual_arm.hpp"

namespace robomill::cell {
namespace {

using robot::read_pose;
using robot::read_vector;

/// Where each of joint_limits goes, of the hybrid machine.
constexpr std::array<robot::Position6 robot::JointLimits::*, robot::joint_limits.size()> of_hybrid = {
    &robot::JointLimits::min_position, &robot::JointLimits::max_position, &robot::JointLimits::max_velocity,
    &robot::JointLimits::max_acceleration, &robot::JointLimits::max_jerk};

enum class Kind { serial, hybrid };

Kind read_kind(io::TomlFile& file, Robots usable) {
  Kind kind = Kind::serial;
  file.choice<Kind>("robot.kind", {{"serial", Kind::serial}, {"hybrid-2upr-rpu", Kind::hybrid}}, kind);
  if (kind == Kind::hybrid && usable == Robots::serial) {
    throw file.reject("robot.kind", "is a hybrid machine; this needs a serial arm",
                      "Forces and stiffness at the joints are known of serial arms alone; robomill smooth takes both");
  }
  return kind;
}

void read_start(io::TomlFile& file, Cell& out) {
  const robot::Arm& arm = out.robot.arm;
  if (!file.numbers("robot.start_joints_deg", "start_joints", units::deg, out.start_joints)) return;
  if (out.start_joints.size() != arm.joints.size()) {
    throw file.reject("robot.start_joints_deg", fmt::format("must hold one angle a joint, {}", arm.joints.size()));
  }
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const robot::Joint& joint = arm.joints[i];
    if (joint.prismatic)
      throw file.reject("robot.start_joints_deg", fmt::format("must be angles; joint {} is prismatic", i + 1));
    if (out.start_joints[i] < joint.min_position || out.start_joints[i] > joint.max_position) {
      throw file.reject("robot.start_joints_deg",
                        fmt::format("must lie within the limits; joint {} has {:.6g} to {:.6g} deg", i + 1,
                                    joint.min_position / units::deg, joint.max_position / units::deg));
    }
  }
}

constexpr std::size_t hybrid_joints = 5;  // q1, q2, q3 the legs, q4, q5 the slides

using robot::HybridMachine;
constexpr io::Field<HybridMachine> hybrid_sizes[] = {
    {"robot.base_half_width_mm", "base_half_width_m", units::mm, &HybridMachine::base_half_width_m},
    {"robot.platform_half_width_mm", "platform_half_width_m", units::mm, &HybridMachine::platform_half_width_m},
    {"robot.platform_offset_mm", "platform_offset_m", units::mm, &HybridMachine::platform_offset_m},
    {"robot.base_offset_mm", "base_offset_m", units::mm, &HybridMachine::base_offset_m},
    {"robot.platform_to_flange_mm", "platform_to_flange_m", units::mm, &HybridMachine::platform_to_flange_m},
};

void read_hybrid(io::TomlFile& file, Cell& out) {
  for (const char* key : {"robot.model", "robot.dh", "robot.urdf", "robot.links", "robot.start_joints_deg",
                          "robot.gamma_deg", "tool.mount_origin_mm", "tool.mount_rotation_deg", "geometry"}) {
    if (file.has(key)) throw file.reject(key, "goes with kind = \"serial\"");
  }
  HybridMachine& machine = out.hybrid.emplace();
  file.fields("", hybrid_sizes, machine);
  const std::vector<bool> prismatic(hybrid_joints, true);
  for (std::size_t k = 0; k < robot::joint_limits.size(); ++k) {
    const auto values = robot::read_joint_limit(file, robot::joint_limits[k], prismatic, out.notes);
    for (std::size_t i = 0; i < values.size(); ++i) {
      double& value = (machine.limits.*of_hybrid[k])(static_cast<Eigen::Index>(i));
      value = values[i].value_or(value);
    }
  }
}

/// @return as read_arm
std::vector<Eigen::Isometry3d> read_serial(io::TomlFile& file, Cell& out) {
  for (const io::Field<HybridMachine>& size : hybrid_sizes) {
    if (file.has(size.key)) throw file.reject(size.key, "goes with kind = \"hybrid-2upr-rpu\"");
  }
  std::vector<Eigen::Isometry3d> link_frames = read_arm(file, out);
  read_start(file, out);
  if (!out.start_joints.empty()) out.home = out.start_joints;
  out.gamma_given = file.number("robot.gamma_deg", "redundant_gamma_rad", units::deg, out.redundant_gamma_rad);
  return link_frames;
}

/// A name that a controller takes.
bool is_name(const std::string& text) {
  const auto plain = [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '_'; };
  return !text.empty() && text.size() <= 32 && std::isalpha(static_cast<unsigned char>(text.front())) != 0 &&
         std::ranges::all_of(text, plain);
}

void read_output(io::TomlFile& file, const char* key, const char* member, path::DigitalOutput& out) {
  if (!file.has(key)) return;
  if (!file.is_number(key)) {
    file.text(key, out.signal);
    if (!is_name(out.signal)) {
      throw file.reject(key, "must be a signal's name: letters, digits and underscores, at most 32");
    }
    return;
  }
  int number = 0;
  file.integer(key, member, number);
  if (number < 0) throw file.reject(key, "must be >= 0");
  out.number = number;
}

/// Of exported programs: what the controller must know of the spindle, after the tool's length.
void read_end_effector(io::TomlFile& file, Cell& out) {
  path::EndEffector& end = out.end_effector;
  end.tip.translate(out.robot.tool_length_m * Eigen::Vector3d::UnitZ());
  const auto number = [&](const char* key, const char* member, std::optional<int>& value) {
    int read = 0;
    if (!file.integer(key, member, read)) return;
    if (read < 1) throw file.reject(key, "must be at least 1");
    value = read;
  };
  number("tool.number", "tool_number", end.tool_number);
  number("tool.load_number", "load_number", end.load_number);
  if (file.text("tool.name", end.tool_name) && !is_name(end.tool_name)) {
    throw file.reject("tool.name", "must be a tooldata's name: letters, digits and underscores, at most 32");
  }
  double mass_kg = 0.0;
  if (file.number("tool.mass_kg", "mass_kg", 1.0, mass_kg)) {
    if (!(mass_kg > 0.0)) throw file.reject("tool.mass_kg", "must be > 0", "Of all that hangs on the flange");
    end.mass_kg = mass_kg;
  }
  end.center_m = read_vector(file, "tool.center_mm", "center_m", units::mm);
  if (end.center_m && !end.mass_kg) throw file.reject("tool.center_mm", "goes with tool.mass_kg");
  read_output(file, "spindle.output", "output", end.spindle);
  read_output(file, "spindle.coolant_output", "coolant_output", end.coolant);
  if (file.number("spindle.spin_up_s", "spin_up_s", 1.0, end.spin_up_s) && !(end.spin_up_s >= 0.0)) {
    throw file.reject("spindle.spin_up_s", "must be >= 0");
  }
}

/// Where the dynamics were measured, and what holds them.
void read_postures(io::TomlFile& file, Cell& out) {
  const robot::Arm& arm = out.robot.arm;
  for (std::size_t i = 0; i < file.tables("postures"); ++i) {
    const std::string row = fmt::format("postures[{}].", i), key = row + "joints_deg";
    PostureEntry entry;
    file.require(key, "One value a joint");
    file.numbers(key, fmt::format("postures[{}].joints", i + 1), units::deg, entry.joints);
    if (entry.joints.size() != arm.joints.size()) {
      throw file.reject(
          key, fmt::format("must hold one value a joint, {}; it holds {}", arm.joints.size(), entry.joints.size()));
    }
    for (std::size_t k = 0; k < arm.joints.size(); ++k) {
      const robot::Joint& joint = arm.joints[k];
      if (joint.prismatic) throw file.reject(key, fmt::format("must be angles; joint {} is prismatic", k + 1));
      if (entry.joints[k] >= joint.min_position && entry.joints[k] <= joint.max_position) continue;
      throw file.reject(key, fmt::format("must lie within the limits; joint {} has {:.6g} to {:.6g} deg", k + 1,
                                         joint.min_position / units::deg, joint.max_position / units::deg));
    }
    const bool frf = file.path(row + "frf", entry.frf), modes = file.path(row + "modes", entry.modes);
    if (frf == modes) {
      if (!frf) file.require(row + "frf", "FRFs of the tool's tip in that posture; or modes");
      throw file.reject(row + "frf", "must not stand beside modes");
    }
    file.choice<bool>(row + "axes", {{"base", false}, {"flange", true}}, entry.flange_axes);
    out.postures.push_back(std::move(entry));
  }
}

/// What the words A, B and C of programs mean.
void read_program_words(io::TomlFile& file, Cell& out) {
  const auto of_key = [&](const char* key, const auto& parse) {
    try {
      parse();
    } catch (const InvalidInput& error) {
      throw file.reject(key, error.parts().rule);
    }
  };
  if (file.text("program.machine", out.machine)) {
    of_key("program.machine", [&] { static_cast<void>(program::parse_machine(out.machine)); });
  }
  if (std::string rotary; file.text("program.rotary", rotary)) {
    of_key("program.rotary", [&] { out.rotary = program::parse_rotary(rotary); });
  }
}

}  // namespace

CellFile read_cell(const io::TomlSource& source, Robots usable) {
  CellFile out;
  out.document = std::make_shared<io::TomlFile>(source);
  io::TomlFile& file = *out.document;
  out.path = file.file_of_part("job.cell", "robot");
  file.skip("smoothing");
  file.require("robot", "Write [robot] with the arm: model, or dh, or urdf");
  const Kind kind = read_kind(file, usable);
  std::vector<Eigen::Isometry3d> link_frames;
  if (kind == Kind::serial) link_frames = read_serial(file, out);
  if (kind == Kind::hybrid) read_hybrid(file, out);
  read_origin(file, out);
  if (file.has("workpiece")) file.require("workpiece.origin_mm");
  if (file.has("tool") && !file.has("tool.teeth")) file.require("tool.length_mm");  // else [tool] may be the cutter's
  out.origin_given = file.has("workpiece.origin_mm");
  out.length_given = file.has("tool.length_mm");
  out.robot.workpiece = read_pose(file, "workpiece.origin_mm", "workpiece.rotation_deg");
  file.number("tool.length_mm", "tool_length_m", units::mm, out.robot.tool_length_m);
  read_end_effector(file, out);
  read_program_words(file, out);
  if (!out.hybrid) {
    read_postures(file, out);
    out.geometry = robot::read_geometry(file, out.robot, out.mount(), link_frames, out.notes);
  }
  std::ranges::move(file.done(), std::back_inserter(out.notes));
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
