#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/path/files/end_effector.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::jobs {

/// A posture of [[postures]] whose dynamics were measured.
struct PostureEntry {
  std::vector<double> joints = {};             ///< [rad or m]
  std::filesystem::path frf = {}, modes = {};  ///< one of them, of the tool's tip
  bool flange_axes = false;                    ///< in the axes of the flange before any mount; else in the base's
};

/// cell.toml: a robot with its tool before a workpiece.
struct CellFile {
  std::filesystem::path path = {};
  robot::Cell cell = {};  ///< a hybrid machine's has no joints, but workpiece and tool all the same
  std::optional<robot::HybridMachine> hybrid = {};  ///< kind = "hybrid-2upr-rpu"
  std::string machine = {};  ///< what A, B, C words of a program mean: "xyzac-trt", "xyzbc-trt", "xyzac-head",
                             ///< "xyzbc-head"; empty where not said
  program::Rotary rotary = program::Rotary::machine;  ///< how the axis goes where those words turn
  double redundant_gamma_rad = 0.0;                   ///< turn of the flange about the tool's axis, robot::ToolPose
  bool gamma_given = false;                           ///< the file says so; else it is free to choose where a stage can
  std::vector<double> start_joints = {};              ///< where the arm stands first [rad]; empty where not said
  bool posture_asked = false;                         ///< they were asked for: nearness to them before margin
  std::vector<double> home = {};  ///< start_joints, else those of the model's own cell; empty where neither is said
  std::string model = {};         ///< robot.model: one of known_arms(); empty where not by name
  std::string maker = {};  ///< of the arm, by its model or its URDF: path::maker_kuka, …; empty where not known
  std::string description = {}, source = {};  ///< of the arm, and where its numbers come from; empty where not said
  std::vector<Assumption> assumed = {};       ///< of these, what nobody publishes
  path::EndEffector end_effector = {};        ///< its mass in torques and modes too
  std::vector<PostureEntry> postures = {};    ///< measured
  std::optional<robot::CellGeometry> geometry = {};  ///< for collisions; the cutter's edges are the caller's to give
  std::vector<std::string> notes = {};               ///< sentences for the user
  std::shared_ptr<io::TomlFile> document = {};       ///< that [smoothing] is read from; empty where built in memory

  /// The spindle frame in the flange frame, tool.mount_…: cell.arm.flange leads to the spindle frame, and what users
  /// say in the flange frame is before it.
  [[nodiscard]] Eigen::Isometry3d mount() const {
    return end_effector.tip * Eigen::Translation3d(0.0, 0.0, -cell.tool_length_m);
  }
};

/// What kinds of robots a reader of the cell can use.
enum class Robots {
  serial,  ///< serial arms alone; a hybrid machine is rejected: stiffness and forces at its joints are not known
  any      ///< serial arms and the hybrid machine: what needs kinematics alone
};

/// Reads [robot], with the arm that it may take by name, [workpiece], [tool], [spindle], [program], [geometry] with its
/// STL files, and [[postures]], of which no file is opened; [smoothing] is another reader's.
/// @throws InvalidInput with file, line, key and value, or with the URDF, its link or joint
[[nodiscard]] ROBOMILL_API CellFile read_cell(const io::TomlSource& source, Robots usable = Robots::serial);

/// The cell's machine with its derivatives.
/// @throws InvalidInput with the file, if a serial arm has not six joints, all revolute
[[nodiscard]] ROBOMILL_API std::unique_ptr<robot::Kinematics> kinematics(const CellFile& file);

/// How programs of the cell are read.
[[nodiscard]] ROBOMILL_API program::ProgramReading program_reading(const CellFile& file);

}  // namespace robomill::jobs
