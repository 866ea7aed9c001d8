#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/table_info.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/robot/collision.hpp"

namespace robomill::robot {

/// [geometry]
[[nodiscard]] const io::TableInfo& geometry_table();

/// [geometry] of a cell.toml, with the STL files that it names; none where there is no such table. The outline of the
/// cutter's edges is not in it: the caller gives it.
/// @param mount        the spindle frame in the flange frame; cell.arm.flange leads to the former
/// @param link_frames  of link k, 0 … n: the frame that the file means, in B for the base and in that after joint k for
///                     the others
/// @param notes        gets sentences on what is not given and so not checked
/// @throws InvalidInput with file, line and key, or with the STL file
[[nodiscard]] std::optional<CellGeometry> read_geometry(io::TomlFile& file, const Cell& cell,
                                                        const Eigen::Isometry3d& mount,
                                                        const std::vector<Eigen::Isometry3d>& link_frames,
                                                        std::vector<std::string>& notes);

}  // namespace robomill::robot
