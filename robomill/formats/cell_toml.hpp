#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::formats {

/// cell.toml: a robot with its tool before a workpiece.
struct CellFile {
  std::filesystem::path path = {};
  robot::Cell cell = {};
  std::string machine = {};          ///< what A, B, C words of a program mean: "xyzac-trt", "xyzbc-trt", "xyzac-head",
                                     ///< "xyzbc-head"; empty where not said
  double redundant_gamma_rad = 0.0;  ///< turn of the flange about the tool's axis, robot::ToolPose
  std::vector<double> start_joints = {};  ///< where the arm stands first [rad]; empty where not said
  std::vector<std::string> notes = {};    ///< sentences for the user
};

/// Reads [robot], [workpiece], [tool] and [program]; [smoothing] is another reader's.
/// @throws InvalidInput with file, line, key and value, or with the URDF, its link or joint
[[nodiscard]] ROBOMILL_API CellFile read_cell(const std::filesystem::path& path);

}  // namespace robomill::formats
