#pragma once
// The tables of cell.toml; [geometry] and [smoothing] are in robot/files and path/files.
#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/robot/files/pose_toml.hpp"

namespace robomill::cell {

/// robot.kind
enum class RobotKind { serial, hybrid };

/// What robot.assumed can name: a key of [robot], or how several begin.
struct Assumable {
  const char *name, *what, *key;  ///< key: what to give instead
};

/// A link's body as the file has it.
struct LinkTable {
  double mass_kg = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  std::vector<double> inertia_kg_m2 = {};  ///< xx, yy, zz, xy, xz, yz about the centre of mass; empty: 0
};

/// [robot], but for the joints' limits (robot::read_joint_limit).
struct RobotTable {
  RobotKind kind = RobotKind::serial;
  robot::HybridMachine machine = {};  ///< its sizes
  std::string model = {};
  std::vector<robot::DhRow> dh = {};
  std::filesystem::path urdf = {};
  std::string urdf_tip = {}, urdf_base = {};
  robot::Placement base = {};
  std::vector<double> stiffness = {}, damping = {}, rotor_inertia = {}, max_torque = {};  ///< one a joint, or none
  std::vector<LinkTable> links = {};
  std::optional<double> gamma_rad = {};
  std::vector<double> start_joints = {};
  std::string description = {}, source = {};
  std::vector<std::string> notes = {};
  std::vector<std::pair<Assumable, std::string>> assumed = {};  ///< with the reason
};
[[nodiscard]] const io::Schema<RobotTable>& robot_table();

/// A list of [robot] with one number a joint.
struct JointList {
  const char *key = nullptr, *member = nullptr;
  std::vector<double> RobotTable::*values = nullptr;
  double robot::Joint::*of_joint = nullptr;
  const char* meaning = nullptr;
};
inline constexpr JointList joint_lists[] = {
    {"joint_stiffness_n_m_per_rad", "stiffness", &RobotTable::stiffness, &robot::Joint::stiffness,
     "one for each joint, N/m where it is prismatic: for stiffness and deflection; robomill stiffness finds it"},
    {"joint_damping_n_m_s_per_rad", "damping", &RobotTable::damping, &robot::Joint::damping,
     "one for each joint: for modes"},
    {"joint_rotor_inertia_kg_m2", "rotor_inertia", &RobotTable::rotor_inertia, &robot::Joint::rotor_inertia,
     "of the drive, referred to the joint: for modes"},
    {"joint_max_torque_n_m", "max_torque", &RobotTable::max_torque, &robot::Joint::max_torque,
     "the greatest torque of each drive at its joint, N where it is prismatic; 0 or not given: no limit"},
};

/// The keys of [robot] for the sizes of the hybrid machine.
[[nodiscard]] const std::vector<io::Row<robot::HybridMachine>>& hybrid_rows();

/// What the robot carries: [tool] but for the cutter.
struct MountedTool {
  double length_m = 0.0;
  robot::Placement mount = {};  ///< the spindle frame in the flange frame
  path::EndEffector end = {};
};
[[nodiscard]] const io::Schema<MountedTool>& mounted_tool_table();
/// [spindle], what switches it.
[[nodiscard]] const io::Schema<path::EndEffector>& spindle_outputs_table();
/// [workpiece]
[[nodiscard]] const io::Schema<robot::Placement>& workpiece_table();
/// [program]
[[nodiscard]] const io::Schema<Cell>& program_words_table();
/// [[postures]]
[[nodiscard]] const io::Schema<PostureEntry>& measured_posture_table();

}  // namespace robomill::cell
