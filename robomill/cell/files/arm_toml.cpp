#include "robomill/cell/files/arm_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/text.hpp"
#include "robomill/robot/files/joint_limits.hpp"
#include "robomill/robot/files/urdf.hpp"

namespace robomill::cell {
namespace {

/// Where each of joint_limits goes.
constexpr std::array<double robot::Joint::*, robot::joint_limits.size()> of_joint = {
    &robot::Joint::min_position, &robot::Joint::max_position, &robot::Joint::max_velocity,
    &robot::Joint::max_acceleration, &robot::Joint::max_jerk};

void require_dh(const io::TomlFile& file, const RobotTable& given) {
  if (!given.dh.empty()) return;
  throw file.reject("robot.dh", "must hold a row a joint", "dh = [{ a_mm = 350, alpha_deg = -90, … }, …]");
}

/// Bodies of the links; with DH they are given in the row's own frame.
void take_links(const io::TomlFile& file, const std::vector<LinkTable>& links, const std::vector<robot::DhRow>& rows,
                robot::Arm& arm) {
  if (!file.has("robot.links")) return;
  if (links.size() != arm.joints.size()) {
    throw file.reject("robot.links",
                      fmt::format("must hold one table a joint, {}; it holds {}", arm.joints.size(), links.size()));
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    robot::Link& link = arm.joints[i].link;
    link = {.mass_kg = links[i].mass_kg, .center_m = links[i].center_m};
    if (const std::vector<double>& tensor = links[i].inertia_kg_m2; !tensor.empty()) {
      link.inertia_kg_m2 << tensor[0], tensor[3], tensor[4], tensor[3], tensor[1], tensor[5], tensor[4], tensor[5],
          tensor[2];
    }
    if (!rows.empty()) {
      const Eigen::Isometry3d frame = robot::dh_link(rows[i]);
      link.center_m = frame * link.center_m;
      link.inertia_kg_m2 = (frame.linear() * link.inertia_kg_m2 * frame.linear().transpose()).eval();
    }
  }
}

std::vector<bool> prismatic_joints(const robot::Arm& arm) {
  std::vector<bool> prismatic;
  for (const robot::Joint& joint : arm.joints) prismatic.push_back(joint.prismatic);
  return prismatic;
}

void take_joint_lists(io::TomlFile& file, const RobotTable& given, robot::Arm& arm, std::vector<std::string>& notes) {
  for (std::size_t k = 0; k < robot::joint_limits.size(); ++k) {
    const auto values = robot::read_joint_limit(file, robot::joint_limits[k], prismatic_joints(arm), notes);
    for (std::size_t i = 0; i < values.size(); ++i)
      arm.joints[i].*of_joint[k] = values[i].value_or(arm.joints[i].*of_joint[k]);
  }
  for (const JointList& list : joint_lists) {
    const std::string key = std::string("robot.") + list.key;
    const std::vector<double>& values = given.*list.values;
    if (!file.has(key)) continue;
    if (values.size() != arm.joints.size()) {
      throw file.reject(key,
                        fmt::format("must hold one number a joint, {}; it holds {}", arm.joints.size(), values.size()));
    }
    for (std::size_t i = 0; i < values.size(); ++i) arm.joints[i].*list.of_joint = values[i];
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
  for (const JointList& list : joint_lists) {
    const std::string key = std::string("robot.") + list.key;
    if (!is_of(list.member) || !file.has(key)) continue;
    InvalidInput::Parts reported = file.reject(key, parts.rule, parts.hint).parts();
    reported.field += parts.field.substr(6, parts.field.find(']') - 5);
    reported.number = parts.number;
    reported.unit = parts.unit;
    reported.value.clear();
    return InvalidInput(std::move(reported));
  }
  return file.located(error);
}

/// What [robot] says of itself.
/// @param given  keys that stand before this file's
void take_provenance(const RobotTable& table, const std::vector<std::string>& given, Cell& out) {
  if (!table.description.empty()) out.description = table.description;
  if (!table.source.empty()) out.source = table.source;
  out.notes.insert(out.notes.end(), table.notes.begin(), table.notes.end());
  for (const auto& [entry, reason] : table.assumed) {
    const std::string_view name = entry.name;
    if (std::ranges::any_of(given, [name](const std::string& key) { return key.starts_with(name); })) continue;
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
std::vector<robot::DhRow> take_model(const io::TomlFile& file, Cell& out) {
  for (const char* key : {"robot.dh", "robot.urdf", "robot.urdf_tip", "robot.urdf_base"}) {
    if (file.has(key)) throw file.reject(key, "must not stand beside model");
  }
  const std::string_view text = known_arm_cell(out.model);
  if (text.empty()) throw unknown_model(file, out.model);
  out.maker = maker_of(out.model);
  io::TomlFile model(io::TomlSource(out.model + ".toml", std::string(text)));
  RobotTable known;
  robot_table().read(model, "robot", known);
  out.robot.arm = robot::arm_from_dh(known.dh, known.base.pose());
  take_joint_lists(model, known, out.robot.arm, out.notes);
  take_links(model, known.links, known.dh, out.robot.arm);
  out.home = known.start_joints;
  take_provenance(known, file.keys("robot"), out);
  return known.dh;
}

/// The arm of a URDF beside the cell.
void read_urdf_arm(const io::TomlFile& file, const RobotTable& given, Cell& out) {
  if (file.has("robot.dh")) throw file.reject("robot.urdf", "must not stand beside dh");
  file.require("robot.urdf_tip", "The link that is the flange");
  robot::UrdfReading reading;
  reading.tip = given.urdf_tip;
  reading.base = given.urdf_base;
  robot::UrdfArm read = robot::read_urdf(given.urdf, reading);
  out.maker = maker_of(read.name);
  if (out.maker.empty()) out.maker = maker_of(given.urdf.stem().string());
  out.robot.arm = std::move(read.arm);
  out.notes = std::move(read.notes);
}

/// The arm alone, as one of three ways gives it. @return its DH rows; none of a URDF
std::vector<robot::DhRow> take_kinematics(const io::TomlFile& file, const RobotTable& given, Cell& out) {
  out.model = given.model;
  if (file.has("robot.model")) return take_model(file, out);
  if (file.has("robot.urdf")) {
    read_urdf_arm(file, given, out);
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
  require_dh(file, given);
  out.robot.arm = file.locate([&] { return robot::arm_from_dh(given.dh); });
  return given.dh;
}

}  // namespace

std::vector<Eigen::Isometry3d> take_arm(io::TomlFile& file, const RobotTable& given, const Eigen::Isometry3d& mount,
                                        Cell& out) {
  const std::vector<robot::DhRow> rows = take_kinematics(file, given, out);
  robot::Arm& arm = out.robot.arm;
  take_joint_lists(file, given, arm, out.notes);
  take_links(file, given.links, rows, arm);
  robot::Joint& first = arm.joints.front();
  const Eigen::Isometry3d base = given.base.pose();
  first.before = base * first.before;
  arm.flange = arm.flange * mount;
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

void take_origin(const RobotTable& given, Cell& out) {
  take_provenance(given, {}, out);
  std::string note;
  const auto add = [&note](const std::string& sentence) { note += note.empty() ? sentence : " " + sentence; };
  if (!out.model.empty()) add(fmt::format("The arm is {}, {}.", out.model, out.description));
  if (!out.source.empty())
    add(fmt::format("Its kinematics and limits are those of {}, but for what its file notes or assumes.", out.source));
  if (!note.empty()) out.notes.push_back(std::move(note));
}

}  // namespace robomill::cell
