#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/path/files/end_effector.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/cell/README.md, "The cell (`cell.hpp`)"

namespace robomill::cell {

/// A posture whose dynamics were measured.
struct PostureEntry {
  std::vector<double> joints = {};             ///< [rad or m]
  std::filesystem::path frf = {}, modes = {};  ///< one of them, of the tool's tip
  bool flange_axes = false;                    ///< in the axes of the flange before any mount; else in the base's
};

/// A robot with its tool before a workpiece.
struct Cell {
  std::filesystem::path path = {};  ///< of the file that describes it, for messages; empty where there is none
  robot::Cell robot = {};           ///< a hybrid machine's has no joints, but workpiece and tool all the same
  std::optional<robot::HybridMachine> hybrid = {};  ///< in the place of the arm
  std::string machine = {};  ///< what A, B, C words of a program mean: "xyzac-trt", "xyzbc-trt", "xyzac-head",
                             ///< "xyzbc-head"; empty where not said
  program::Rotary rotary = program::Rotary::machine;    ///< how the axis goes where those words turn
  program::ToolChoice tool_choice = {};                 ///< what of a program is read; none: it has one tool
  std::vector<program::WorkFrame> program_frames = {};  ///< of G-code, with their offsets in the control's table
  double redundant_gamma_rad = 0.0;                     ///< turn of the flange about the tool's axis, robot::ToolPose
  bool gamma_given = false;                             ///< that turn is prescribed; else it is free to choose
  bool origin_given = true, length_given = true;        ///< of workpiece and tool; else they are taken for zero
  std::vector<double> start_joints = {};                ///< where the arm stands first [rad]; empty where not said
  bool posture_asked = false;                           ///< they were asked for: nearness to them before margin
  std::vector<double> home = {};  ///< start_joints, else those of the model's own cell; empty where neither is said
  std::string model = {};         ///< of the arm: one of known_arms(); empty where not by name
  std::string maker = {};         ///< of the arm: path::maker_kuka, …; empty where not known
  std::string description = {}, source = {};         ///< of the arm, and where its numbers come from
  std::vector<Assumption> assumed = {};              ///< of these, what nobody publishes
  path::EndEffector end_effector = {};               ///< its mass in torques and modes too
  std::vector<PostureEntry> postures = {};           ///< measured
  std::optional<robot::CellGeometry> geometry = {};  ///< for collisions; the cutter's edges are the caller's to give
  std::vector<std::string> notes = {};               ///< sentences for the user

  /// The spindle frame in the flange frame: robot.arm.flange leads to the spindle frame, and what users say in the
  /// flange frame is before it.
  [[nodiscard]] Eigen::Isometry3d mount() const {
    return end_effector.tip * Eigen::Translation3d(0.0, 0.0, -robot.tool_length_m);
  }
};

/// The cell's machine with its derivatives.
/// @param max_condition_number  of a serial arm: beyond it a position is singular
/// @throws InvalidInput with the cell's file, if a serial arm has not six joints, all revolute
[[nodiscard]] ROBOMILL_API std::unique_ptr<robot::Kinematics> kinematics(
    const Cell& cell, double max_condition_number = robot::SingularityOptions{}.max_condition_number);

/// How programs of the cell are read.
[[nodiscard]] ROBOMILL_API program::ProgramReading program_reading(const Cell& cell);

/// What a program that is run in the cell takes for granted of it. Nothing of a cell without a file.
/// @param gamma_chosen  how the flange turns about the tool is chosen where the cell does not say it
[[nodiscard]] ROBOMILL_API std::vector<Assumption> assumed_along_program(const Cell& cell, bool gamma_chosen);

}  // namespace robomill::cell
