#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "robomill/cell/cell.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::cell {

/// The arm of a cell.toml, by its name (robot.model), in DH rows or as a URDF, with where it stands and what is bolted
/// to its flange.
/// @return of the base and of every link the frame that [geometry] means, in B and in that after the link's joint
[[nodiscard]] std::vector<Eigen::Isometry3d> read_arm(io::TomlFile& file, Cell& out);

/// Where the numbers of [robot] come from: robot.description, robot.source, robot.notes and what robot.assumed lists;
/// of all that a note. After read_arm: of a model what the cell gives itself is not assumed.
void read_origin(io::TomlFile& file, Cell& out);

}  // namespace robomill::cell
