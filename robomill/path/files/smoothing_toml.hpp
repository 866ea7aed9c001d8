#pragma once
#include <optional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/path/options.hpp"
#include "robomill/robot/kinematics.hpp"

// Method: robomill/path/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::path {

/// [smoothing] of cell.toml.
struct SmoothingFile {
  SmoothingOptions options = {};
  bool free_gamma = false;  ///< the flange may turn about the tool's axis along the way
  /// Of each joint's position servo; empty where not given, then no tracking error can be computed.
  std::vector<double> drive_bandwidth_hz = {};
  double drive_damping_ratio = 0.7;  ///< > 0; of the servos
  /// Natural frequency of the flexible joint behind each drive; empty: stiff.
  std::vector<double> flexible_joint_hz = {};
  double flexible_joint_damping_ratio = 0.05;  ///< >= 0
};

/// Whether a cell.toml has [smoothing].
[[nodiscard]] ROBOMILL_API bool has_smoothing(const io::TomlFile& cell);

/// Reads [smoothing] and checks the joints' limits, which smoothing needs all of. Errors of what smooths by the options
/// can be located in the document afterwards.
/// @param cell    whose other tables have been read
/// @param limits  of the machine that it describes (a URDF gives some of them)
/// @param joints  how many
/// @param method  stands before the file's
/// @throws InvalidInput with file, line, key, value and rule
[[nodiscard]] ROBOMILL_API SmoothingFile read_smoothing(io::TomlFile& cell, const robot::JointLimits& limits,
                                                        int joints, std::optional<Method> method = {});

}  // namespace robomill::path
