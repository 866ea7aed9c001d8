#include "robomill/cell/files/cell_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/robot/files/joint_limits.hpp"

namespace robomill::cell {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::TomlFile;

constexpr Name<RobotKind> robot_kinds[] = {{"serial", RobotKind::serial}, {"hybrid-2upr-rpu", RobotKind::hybrid}};
constexpr Name<bool> posture_axes[] = {{"base", false}, {"flange", true}};

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

const Schema<robot::DhRow>& dh_table() {
  using robot::DhRow;
  static const Schema<DhRow> table(
      "dh_row", "a row of standard DH, Rz(θ + offset) Tz(d) Tx(a) Rx(α)",
      {key("a_mm", &DhRow::a_m, "a"), key("alpha_deg", &DhRow::alpha_rad, "α"), key("d_mm", &DhRow::d_m, "d"),
       key("theta_offset_deg", &DhRow::theta_offset_rad, "offset of θ")});
  return table;
}

const Schema<LinkTable>& link_table() {
  static const Schema<LinkTable> table(
      "link", "a link's body, in the frame at the end of the joint's DH row, or of its URDF link",
      {key("mass_kg", &LinkTable::mass_kg, "of the link").as("link.mass_kg").required().at_least(0.0),
       key("center_mm", &LinkTable::center_m, "centre of mass").as("link.center_m").entries(3),
       key("inertia_kg_m2", &LinkTable::inertia_kg_m2, "about the centre of mass: xx, yy, zz, xy, xz, yz")
           .as("link.inertia_kg_m2")
           .entries(6, "[xx, yy, zz, xy, xz, yz]")});
  return table;
}

/// The keys of [robot.assumed].
const Schema<RobotTable>& assumed_table() {
  static const Schema<RobotTable> table("robot_assumed", "reasons for values that are not published", [] {
    std::vector<Row<RobotTable>> rows;
    for (const Assumable& entry : assumable) {
      Row<RobotTable> row = declared<RobotTable>(entry.name, Holds::text, "the reason");
      rows.push_back(row.read_by([entry](TomlFile& file, const std::string& path, RobotTable& out) {
        if (std::string reason; file.text(path, reason)) out.assumed.emplace_back(entry, reason);
      }));
    }
    return rows;
  }());
  return table;
}

Row<RobotTable> assumed_key() {
  Row<RobotTable> row = declared<RobotTable>(
      "assumed", Holds::table, "the reason for values that are not published: they are marked as assumed");
  row.key.table = &assumed_table().info();
  return row.read_by(
      [](TomlFile& file, const std::string& path, RobotTable& out) { assumed_table().read(file, path, out); });
}

std::vector<Row<RobotTable>> robot_rows() {
  std::vector<Row<RobotTable>> rows = {
      key("kind", &RobotTable::kind, robot_kinds,
          "the hybrid machine is for smooth and cell check alone; forces and stiffness need a serial arm"),
      key("model", &RobotTable::model,
          "name of an arm that the program contains: kinematics, limits, stiffness and masses. Keys given beside it "
          "take "
          "precedence; dh and urdf cannot be combined with it"),
      key("dh", &RobotTable::dh, dh_table(), "one row for each joint: standard DH, Rz(θ + offset) Tz(d) Tx(a) Rx(α)")
          .as("dh"),
      key("urdf", &RobotTable::urdf,
          "in place of dh: limits, velocity, damping and masses come from it; fixed joints are folded in. Rejected: "
          "mimic, floating and planar joints, links that are no tree, more than 2,000 joints"),
      key("urdf_tip", &RobotTable::urdf_tip, "the link that is the flange"),
      key("urdf_base", &RobotTable::urdf_base, "the link that is the base; without it the root")};
  robot::add_placement(rows, &RobotTable::base, "base_",
                       "the first row, the URDF's base, or the model's controller frame in the robot's base frame");
  robot::add_joint_limits(rows);
  for (const JointList& list : joint_lists) {
    rows.push_back(key(list.key, list.values, list.meaning).as(list.member).or_one());
  }
  io::add_rows<RobotTable>(
      rows,
      {key("links", &RobotTable::links, link_table(),
           "one table a joint, in the frame at the end of its DH row, or of its URDF link")
           .as("joints"),
       key("gamma_deg", &RobotTable::gamma_rad,
           "rotation of the flange about the tool's axis, without it 0; smooth chooses it where it is not given")
           .as("redundant_gamma_rad"),
       key("start_joints_deg", &RobotTable::start_joints,
           "the arm's start posture, and its home: programs begin in its configuration, without whole turns; --posture "
           "takes precedence")
           .as("start_joints")
           .or_one(),
       key("description", &RobotTable::description, "the arm"), key("source", &RobotTable::source, "of its numbers"),
       key("notes", &RobotTable::notes, "shown to the user").or_one(), assumed_key()});
  for (const Row<robot::HybridMachine>& row : hybrid_rows()) rows.push_back(of(&RobotTable::machine, row));
  return rows;
}

/// A name that a controller takes.
bool is_name(const std::string& text) {
  const auto plain = [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '_'; };
  return !text.empty() && text.size() <= 32 && std::isalpha(static_cast<unsigned char>(text.front())) != 0 &&
         std::ranges::all_of(text, plain);
}

void read_tool_name(TomlFile& file, const std::string& path, MountedTool& out) {
  if (file.text(path, out.end.tool_name) && !is_name(out.end.tool_name)) {
    throw file.reject(path, "must be a tooldata's name: letters, digits and underscores, at most 32");
  }
}

void read_output(TomlFile& file, const std::string& path, path::DigitalOutput& out) {
  if (!file.has(path)) return;
  if (!file.is_number(path)) {
    file.text(path, out.signal);
    if (!is_name(out.signal)) {
      throw file.reject(path, "must be a signal's name: letters, digits and underscores, at most 32");
    }
    return;
  }
  int number = 0;
  file.integer(path, path, number);
  if (number < 0) throw file.reject(path, "must be >= 0");
  out.number = number;
}

Row<path::EndEffector> output_key(const char* name, path::DigitalOutput path::EndEffector::*output,
                                  const char* meaning) {
  return declared<path::EndEffector>(name, Holds::text, meaning)
      .or_also(Holds::integer)
      .read_by([output](TomlFile& file, const std::string& path, path::EndEffector& out) {
        read_output(file, path, out.*output);
      });
}

/// The words and what they mean are the program readers'.
template <class F>
void parse_word(const TomlFile& file, const std::string& path, F&& parse) {
  try {
    parse();
  } catch (const InvalidInput& error) {
    throw file.reject(path, error.parts().rule);
  }
}

void read_machine(TomlFile& file, const std::string& path, Cell& out) {
  if (!file.text(path, out.machine)) return;
  parse_word(file, path, [&] { static_cast<void>(program::parse_machine(out.machine)); });
}

void read_rotary(TomlFile& file, const std::string& path, Cell& out) {
  std::string rotary;
  if (!file.text(path, rotary)) return;
  parse_word(file, path, [&] { out.rotary = program::parse_rotary(rotary); });
}

void read_frame_code(TomlFile& file, const std::string& path, program::WorkFrame& out) {
  if (!file.text(path, out.code)) return;
  parse_word(file, path, [&] { static_cast<void>(program::parse_work_frame(out.code)); });
}

const Schema<program::WorkFrame>& work_frame_table() {
  using program::WorkFrame;
  static const Schema<WorkFrame> table(
      "work_frame", "a work frame of G-code, as the control's table has it",
      {key("code", &WorkFrame::code,
           "as the program chooses it: \"G55\", \"G59.1\", \"G54.1 P3\", \"G154 P2\", \"G112\"")
           .required("The frame's G code")
           .read_by(read_frame_code),
       key("origin_mm", &WorkFrame::origin_m, "its zero in machine coordinates")
           .required("The offsets of the control's table")
           .entries(3, "[x, y, z]")});
  return table;
}

/// Each of them once.
void require_other_frames(const TomlFile& file, const std::string& path, const std::vector<program::WorkFrame>& all) {
  const auto key_of = [&](std::size_t i) { return fmt::format("{}[{}].code", path, i); };
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t first = 0; first < i; ++first) {
      if (program::parse_work_frame(all[first].code) != program::parse_work_frame(all[i].code)) continue;
      throw file.reject(key_of(i), fmt::format("is given before, as \"{}\" in {}", all[first].code,
                                               file.reject(key_of(first), {}).parts().where));
    }
  }
}

Row<Cell> frames_key() {
  Row<Cell> row = key("frames", &Cell::program_frames, work_frame_table(),
                      "offsets of the work frames that programs in G-code use, all of them where a program uses "
                      "several; workpiece is the frame in which the program begins")
                      .as("frames");
  row.read = [read = row.read](TomlFile& file, const std::string& path, const Row<Cell>& self, Cell& out) {
    read(file, path, self, out);
    require_other_frames(file, path, out.program_frames);
  };
  return row;
}

}  // namespace

const std::vector<Row<robot::HybridMachine>>& hybrid_rows() {
  using robot::HybridMachine;
  static const std::vector<Row<HybridMachine>> rows = {
      key("base_half_width_mm", &HybridMachine::base_half_width_m, "of the hybrid machine: a").above(0.0),
      key("platform_half_width_mm", &HybridMachine::platform_half_width_m, "of the hybrid machine: b").above(0.0),
      key("platform_offset_mm", &HybridMachine::platform_offset_m, "of the hybrid machine: c"),
      key("base_offset_mm", &HybridMachine::base_offset_m, "of the hybrid machine: e").above(0.0),
      key("platform_to_flange_mm", &HybridMachine::platform_to_flange_m,
          "of the hybrid machine: the part of h without the tool's length")
          .at_least(0.0)};
  return rows;
}

const Schema<RobotTable>& robot_table() {
  static const Schema<RobotTable> table("robot", "the arm, or the hybrid machine", robot_rows());
  return table;
}

const Schema<MountedTool>& mounted_tool_table() {
  static const Schema<MountedTool> table("tool", "what the robot carries", [] {
    std::vector<Row<MountedTool>> rows = {
        key("length_mm", &MountedTool::length_m, "from the spindle frame to the tip, along its z")
            .as("tool_length_m")
            .at_least(0.0)};
    robot::add_placement(rows, &MountedTool::mount, "mount_", "the spindle frame in the flange frame");
    const auto end = [&](Row<path::EndEffector> row) { rows.push_back(of(&MountedTool::end, std::move(row))); };
    end(key("number", &path::EndEffector::tool_number, "for exported programs: KUKA's TOOL_DATA[n]").at_least(1.0));
    end(key("load_number", &path::EndEffector::load_number,
            "for exported programs: KUKA's LOAD_DATA[n]; without it the tool's number")
            .at_least(1.0));
    rows.push_back(
        declared<MountedTool>("name", Holds::text, "for exported programs: an ABB tooldata on the controller")
            .read_by(read_tool_name));
    end(key("mass_kg", &path::EndEffector::mass_kg,
            "total mass on the flange, for torques, modes and exported programs; without it none")
            .above(0.0, "Of all that hangs on the flange"));
    end(key("center_mm", &path::EndEffector::center_m,
            "centre of that mass in the flange frame; without it half-way to the tip")
            .entries(3));
    return rows;
  }());
  return table;
}

const Schema<path::EndEffector>& spindle_outputs_table() {
  using path::EndEffector;
  static const Schema<EndEffector> table(
      "spindle", "how a controller switches the spindle",
      {output_key("output", &EndEffector::spindle,
                  "for exported programs: digital output; KUKA and Universal Robots take a number, ABB a name"),
       output_key("coolant_output", &EndEffector::coolant, "the same for the coolant"),
       key("spin_up_s", &EndEffector::spin_up_s, "waiting time after the spindle was switched on").at_least(0.0)});
  return table;
}

const Schema<robot::Placement>& workpiece_table() {
  static const Schema<robot::Placement> table("workpiece", "the program's frame in the robot's base frame",
                                              robot::placement_rows("", "the program's frame"));
  return table;
}

const Schema<Cell>& program_words_table() {
  static const Schema<Cell> table(
      "program", "how NC programs are read",
      {key("machine", &Cell::machine, "the machine that A, B, C words are of")
           .words({"xyzac-trt", "xyzbc-trt", "xyzac-head", "xyzbc-head"})
           .read_by(read_machine),
       declared<Cell>("rotary", Holds::word,
                      "motion of the axis where A, B, C turn: each evenly to its programmed value (default), or along "
                      "the shortest arc between the ends of a straight move")
           .words({"machine", "great-circle"})
           .read_by(read_rotary),
       of(&Cell::tool_choice,
          key("tool", &program::ToolChoice::number,
              "the tool whose part of a program is read: the number that T, LOADTL or LOAD/TOOL gives it (tool.number "
              "is the robot controller's and chooses none); without it a program may cut with one tool alone")
              .as("tool.number")
              .at_least(0.0)),
       of(&Cell::tool_choice,
          key("tool_name", &program::ToolChoice::name,
              "in place of tool: the name that TOOL PATH gives it, of programs that give no numbers")
              .as("tool.name")),
       of(&Cell::tool_choice,
          key("tool_part", &program::ToolChoice::part,
              "which of the tool's parts is read: the first, second, … of its moves between those of other tools; "
              "without it the tool has one part")
              .as("tool.part")
              .at_least(1.0)),
       frames_key()});
  return table;
}

const Schema<PostureEntry>& measured_posture_table() {
  static const Schema<PostureEntry> table(
      "postures", "measured dynamics",
      {key("joints_deg", &PostureEntry::joints, "within the limits")
           .as("joints")
           .required("One value a joint")
           .or_one(),
       key("frf", &PostureEntry::frf, "FRFs of the tool's tip in x, y, z in that posture; or modes"),
       key("modes", &PostureEntry::modes, "the same as modes"),
       key("axes", &PostureEntry::flange_axes, posture_axes,
           "axes of these; flange: the frame after the last DH row, before any mount, which needs all nine FRFs")});
  return table;
}

}  // namespace robomill::cell
