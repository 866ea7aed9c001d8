#include "robomill/cell/files/arm_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/text.hpp"
#include "robomill/robot/files/joint_limits.hpp"
#include "robomill/robot/files/pose_toml.hpp"
#include "robomill/robot/files/urdf.hpp"

namespace robomill::cell {
namespace {

using robot::read_pose;
using robot::read_vector;

/// Other lists with one value a joint.
constexpr io::Field<robot::Joint> joint_lists[] = {
    {"robot.joint_stiffness_n_m_per_rad", "stiffness", 1.0, &robot::Joint::stiffness},
    {"robot.joint_damping_n_m_s_per_rad", "damping", 1.0, &robot::Joint::damping},
    {"robot.joint_rotor_inertia_kg_m2", "rotor_inertia", 1.0, &robot::Joint::rotor_inertia},
    {"robot.joint_max_torque_n_m", "max_torque", 1.0, &robot::Joint::max_torque},
};

/// Where each of joint_limits goes.
constexpr std::array<double robot::Joint::*, robot::joint_limits.size()> of_joint = {
    &robot::Joint::min_position, &robot::Joint::max_position, &robot::Joint::max_velocity,
    &robot::Joint::max_acceleration, &robot::Joint::max_jerk};
std::vector<robot::DhRow> read_dh(io::TomlFile& file) {
  std::vector<robot::DhRow> rows(file.tables("robot.dh"));
  if (rows.empty())
    throw file.reject("robot.dh", "must hold a row a joint", "dh = [{ a_mm = 350, alpha_deg = -90, … }, …]");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = [&](const char* name, const char* member, double factor, double& value) {
      file.number(fmt::format("robot.dh[{}].{}", i, name), fmt::format("dh[{}].{}", i + 1, member), factor, value);
    };
    number("a_mm", "a_m", units::mm, rows[i].a_m);
    number("alpha_deg", "alpha_rad", units::deg, rows[i].alpha_rad);
    number("d_mm", "d_m", units::mm, rows[i].d_m);
    number("theta_offset_deg", "theta_offset_rad", units::deg, rows[i].theta_offset_rad);
  }
  return rows;
}

/// Bodies of the links; with DH they are given in the row's own frame.
void read_links(io::TomlFile& file, const std::vector<robot::DhRow>& rows, robot::Arm& arm) {
  if (!file.has("robot.links")) return;
  const std::size_t count = file.tables("robot.links");
  if (count != arm.joints.size()) {
    throw file.reject("robot.links",
                      fmt::format("must hold one table a joint, {}; it holds {}", arm.joints.size(), count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string key = fmt::format("robot.links[{}].", i), member = fmt::format("joints[{}].link.", i + 1);
    robot::Link link;
    file.require(key + "mass_kg");
    file.number(key + "mass_kg", member + "mass_kg", 1.0, link.mass_kg);
    if (const auto center_m = read_vector(file, key + "center_mm", member + "center_m", units::mm)) {
      link.center_m = *center_m;
    }
    std::vector<double> tensor;
    if (file.numbers(key + "inertia_kg_m2", member + "inertia_kg_m2", 1.0, tensor)) {
      if (tensor.size() != 6) throw file.reject(key + "inertia_kg_m2", "must be [xx, yy, zz, xy, xz, yz]");
      link.inertia_kg_m2 << tensor[0], tensor[3], tensor[4], tensor[3], tensor[1], tensor[5], tensor[4], tensor[5],
          tensor[2];
    }
    if (!rows.empty()) {
      const Eigen::Isometry3d frame = robot::dh_link(rows[i]);
      link.center_m = frame * link.center_m;
      link.inertia_kg_m2 = (frame.linear() * link.inertia_kg_m2 * frame.linear().transpose()).eval();
    }
    arm.joints[i].link = link;
  }
}

std::vector<bool> prismatic_joints(const robot::Arm& arm) {
  std::vector<bool> prismatic;
  for (const robot::Joint& joint : arm.joints) prismatic.push_back(joint.prismatic);
  return prismatic;
}

void read_joint_lists(io::TomlFile& file, robot::Arm& arm, std::vector<std::string>& notes) {
  for (std::size_t k = 0; k < robot::joint_limits.size(); ++k) {
    const auto values = robot::read_joint_limit(file, robot::joint_limits[k], prismatic_joints(arm), notes);
    for (std::size_t i = 0; i < values.size(); ++i)
      arm.joints[i].*of_joint[k] = values[i].value_or(arm.joints[i].*of_joint[k]);
  }
  for (const io::Field<robot::Joint>& list : joint_lists) {
    std::vector<double> values;
    if (!file.numbers(list.key, list.member, list.factor, values)) continue;
    if (values.size() != arm.joints.size()) {
      throw file.reject(list.key,
                        fmt::format("must hold one number a joint, {}; it holds {}", arm.joints.size(), values.size()));
    }
    for (std::size_t i = 0; i < values.size(); ++i) arm.joints[i].*list.value = values[i];
  }
}

/// An error about a joint's member, reported with the list's key and the joint's place in it.
InvalidInput located(const io::TomlFile& file, const robot::Arm& arm, const InvalidInput& error) {
  const InvalidInput::Parts& parts = error.parts();
  const auto is_of = [&](const char* member) {
    return parts.field.starts_with("joints[") && parts.field.ends_with(std::string("].") + member);
  };
  for (const robot::JointLimit& limit : robot::joint_limits) {
    if (!is_of(limit.name)) continue;
    return robot::located_limit(file, limit, prismatic_joints(arm), std::stoul(parts.field.substr(7)) - 1, error);
  }
  for (const io::Field<robot::Joint>& list : joint_lists) {
    if (!is_of(list.member) || !file.has(list.key)) continue;
    InvalidInput::Parts reported = file.reject(list.key, parts.rule, parts.hint).parts();
    reported.field += parts.field.substr(6, parts.field.find(']') - 5);
    reported.number = parts.number;
    reported.unit = parts.unit;
    reported.value.clear();
    return InvalidInput(std::move(reported));
  }
  return file.located(error);
}

/// What robot.assumed can name: a key of [robot], or how several begin.
struct Assumable {
  const char *name, *what, *key;  ///< key: what to give instead
};
constexpr Assumable assumable[] = {
    {"joint_min_position", "Lower limits of the joints", "robot.joint_min_position"},
    {"joint_max_position", "Upper limits of the joints", "robot.joint_max_position"},
    {"joint_max_velocity", "Velocities of the joints", "robot.joint_max_velocity"},
    {"joint_max_acceleration", "Accelerations of the joints", "robot.joint_max_acceleration"},
    {"joint_max_jerk", "Jerks of the joints", "robot.joint_max_jerk"},
    {"joint_max_torque", "Torques of the joints", "robot.joint_max_torque_n_m"},
    {"joint_stiffness", "Stiffness of the joints", "robot.joint_stiffness_n_m_per_rad"},
    {"joint_damping", "Damping of the joints", "robot.joint_damping_n_m_s_per_rad"},
    {"joint_rotor_inertia", "Rotor inertias of the joints", "robot.joint_rotor_inertia_kg_m2"},
    {"links", "Masses of the links", "robot.links"},
};

/// What [robot] says of itself.
/// @param given  keys that stand before this file's
void read_provenance(io::TomlFile& file, const std::vector<std::string>& given, Cell& out) {
  file.text("robot.description", out.description);
  file.text("robot.source", out.source);
  std::vector<std::string> notes;
  file.texts("robot.notes", notes);
  out.notes.insert(out.notes.end(), notes.begin(), notes.end());
  for (const Assumable& entry : assumable) {
    std::string reason;
    if (!file.text(fmt::format("robot.assumed.{}", entry.name), reason)) continue;
    const auto is_it = [&](const std::string& key) { return key.starts_with(entry.name); };
    if (std::ranges::any_of(given, is_it)) continue;
    out.assumed.push_back(
        {.what = entry.what, .taken = reason, .key = entry.key, .file = out.path.filename().string()});
  }
}

InvalidInput unknown_model(const io::TomlFile& file, const std::string& name) {
  std::vector<std::string> names;
  std::string list;
  for (const KnownArm& arm : known_arms()) {
    list += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", arm.name);
    names.push_back(arm.name);
  }
  const std::string near = io::nearest_word(name, names);
  return file.reject("robot.model", "must be one of " + list,
                     near.empty() ? "Or give the arm as dh or urdf" : fmt::format("Did you mean \"{}\"?", near));
}

/// The arm that robot.model names, with all that is known of it.
std::vector<robot::DhRow> read_model(io::TomlFile& file, Cell& out) {
  file.text("robot.model", out.model);
  for (const char* key : {"robot.dh", "robot.urdf", "robot.urdf_tip", "robot.urdf_base"}) {
    if (file.has(key)) throw file.reject(key, "must not stand beside model");
  }
  const std::string_view text = known_arm_cell(out.model);
  if (text.empty()) throw unknown_model(file, out.model);
  out.maker = maker_of(out.model);
  io::TomlFile model(io::TomlSource(out.model + ".toml", std::string(text)));
  std::vector<robot::DhRow> rows = read_dh(model);
  out.robot.arm = robot::arm_from_dh(rows, read_pose(model, "robot.base_origin_mm", "robot.base_rotation_deg"));
  read_joint_lists(model, out.robot.arm, out.notes);
  read_links(model, rows, out.robot.arm);
  model.numbers("robot.start_joints_deg", "home", units::deg, out.home);
  read_provenance(model, file.keys("robot"), out);
  return rows;
}

/// The arm of a URDF beside the cell.
void read_urdf_arm(io::TomlFile& file, Cell& out) {
  std::filesystem::path urdf;
  file.path("robot.urdf", urdf);
  if (file.has("robot.dh")) throw file.reject("robot.urdf", "must not stand beside dh");
  file.require("robot.urdf_tip", "The link that is the flange");
  robot::UrdfReading reading;
  file.text("robot.urdf_tip", reading.tip);
  file.text("robot.urdf_base", reading.base);
  robot::UrdfArm read = robot::read_urdf(urdf, reading);
  out.maker = maker_of(read.name);
  if (out.maker.empty()) out.maker = maker_of(urdf.stem().string());
  out.robot.arm = std::move(read.arm);
  out.notes = std::move(read.notes);
}

/// The arm alone, as one of three ways gives it. @return its DH rows; none of a URDF
std::vector<robot::DhRow> read_kinematics(io::TomlFile& file, Cell& out) {
  for (const char* key : {"robot.model", "robot.urdf", "robot.urdf_tip", "robot.urdf_base"}) file.skip(key);
  if (file.has("robot.model")) return read_model(file, out);
  if (file.has("robot.urdf")) {
    read_urdf_arm(file, out);
    return {};
  }
  if (!file.has("robot.dh")) {
    file.require(
        "robot.model",
        "Give the arm by its name, as urdf = \"arm.urdf\", or as dh = [{ a_mm = …, alpha_deg = …, d_mm = … }, …]");
  }
  for (const char* key : {"robot.urdf_tip", "robot.urdf_base"}) {
    if (file.has(key)) throw file.reject(key, "goes with robot.urdf");
  }
  std::vector<robot::DhRow> rows = read_dh(file);
  out.robot.arm = file.locate([&] { return robot::arm_from_dh(rows); });
  return rows;
}

}  // namespace

std::vector<Eigen::Isometry3d> read_arm(io::TomlFile& file, Cell& out) {
  const std::vector<robot::DhRow> rows = read_kinematics(file, out);
  robot::Arm& arm = out.robot.arm;
  read_joint_lists(file, arm, out.notes);
  read_links(file, rows, arm);
  robot::Joint& first = arm.joints.front();
  const Eigen::Isometry3d base = read_pose(file, "robot.base_origin_mm", "robot.base_rotation_deg");
  first.before = base * first.before;
  out.end_effector.tip = read_pose(file, "tool.mount_origin_mm", "tool.mount_rotation_deg");
  arm.flange = arm.flange * out.end_effector.tip;
  try {
    arm.validate();
  } catch (const InvalidInput& error) {
    throw located(file, arm, error);
  }
  std::vector<Eigen::Isometry3d> link_frames = {base};
  for (const robot::DhRow& row : rows) link_frames.push_back(robot::dh_link(row));
  link_frames.resize(arm.joints.size() + 1, Eigen::Isometry3d::Identity());  // a URDF's links are where its joints are
  return link_frames;
}

void read_origin(io::TomlFile& file, Cell& out) {
  read_provenance(file, {}, out);
  std::string note;
  const auto add = [&note](const std::string& sentence) { note += note.empty() ? sentence : " " + sentence; };
  if (!out.model.empty()) add(fmt::format("The arm is {}, {}.", out.model, out.description));
  if (!out.source.empty())
    add(fmt::format("Its kinematics and limits are those of {}, but for what its file notes or assumes.", out.source));
  if (!note.empty()) out.notes.push_back(std::move(note));
}

}  // namespace robomill::cell
