#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "robomill/io/toml/file.hpp"

namespace robomill::robot {

/// Three numbers, times the factor; none where the key is absent.
/// @throws InvalidInput if there are not three
[[nodiscard]] std::optional<Eigen::Vector3d> read_vector(io::TomlFile& file, const std::string& key,
                                                         const std::string& member, double factor);

/// An origin in mm and three angles in degrees about x, y and z: R = Rz Ry Rx. What is absent is 0.
[[nodiscard]] Eigen::Isometry3d read_pose(io::TomlFile& file, const std::string& origin_key,
                                          const std::string& rotation_key);

}  // namespace robomill::robot
