#pragma once
#include <cstddef>
#include <filesystem>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/identify.hpp"

// Method: robomill/robot/README.md, "Files"

namespace robomill::robot {

/// Loads on a robot's tool and the displacements measured.
struct LoadsFile {
  std::filesystem::path path = {};
  std::vector<Load> loads = {};
  std::vector<std::size_t> line = {};   ///< of each, from 1
  std::vector<std::string> notes = {};  ///< sentences for the user
};

/// Reads loads.csv: columns q1_deg … qn_deg (q2_mm of a prismatic joint) without load, fx_n, fy_n, fz_n on the robot,
/// dx_mm, dy_mm, dz_mm of the point, all in the robot's base frame; optionally mx_n_m, my_n_m, mz_n_m and deviation_mm.
/// @throws InvalidInput with file, line, column and value
[[nodiscard]] ROBOMILL_API LoadsFile read_loads(const std::filesystem::path& path, const Arm& arm);

/// robot::identify_joint_stiffness; an error about a load names its file and line.
[[nodiscard]] ROBOMILL_API IdentifiedStiffness identify_joint_stiffness(const Arm& arm, const Eigen::Vector3d& point_m,
                                                                        const LoadsFile& file,
                                                                        const IdentifyOptions& options = {});

}  // namespace robomill::robot
