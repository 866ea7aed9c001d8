#pragma once
#include <array>
#include <memory>

#include "robomill/base/export.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/io/toml_source.hpp"

// Method: robomill/cell/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::cell {

/// Each of them says that [robot] is an arm, and not only where one stands.
inline constexpr std::array arm_keys = {"robot.model", "robot.dh", "robot.urdf", "robot.kind"};

/// cell.toml: a cell, and the document that it was read from.
struct CellFile : Cell {
  std::shared_ptr<io::TomlFile> document = {};  ///< that [smoothing] is read from
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

}  // namespace robomill::cell
