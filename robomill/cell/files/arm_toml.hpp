#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/cell/files/cell_tables.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::cell {

/// The arm of a cell.toml, by its name (robot.model), in DH rows or as a URDF, with where it stands and what is bolted
/// to its flange.
/// @param given  [robot]; the joints' limits are read from the file
/// @param mount  the spindle frame in the flange frame
/// @return of the base and of every link the frame that [geometry] means, in B and in that after the link's joint
/// @throws InvalidInput with file, line and key
[[nodiscard]] std::vector<Eigen::Isometry3d> take_arm(io::TomlFile& file, const RobotTable& given,
                                                      const Eigen::Isometry3d& mount, Cell& out);

/// Where the numbers of [robot] come from: robot.description, robot.source, robot.notes and what robot.assumed lists;
/// of all that a note. After take_arm: of a model what the cell gives itself is not assumed.
void take_origin(const RobotTable& given, Cell& out);

}  // namespace robomill::cell
