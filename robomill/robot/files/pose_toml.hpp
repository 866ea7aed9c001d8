#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"

namespace robomill::robot {

/// An origin and three angles about x, y and z.
struct Placement {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero(), rotation_rad = Eigen::Vector3d::Zero();
  /// R = Rz Ry Rx
  [[nodiscard]] Eigen::Isometry3d pose() const;
};

/// Its keys, origin_mm and rotation_deg.
/// @param before  the keys' names: "base_"
/// @param of      what is placed, in which frame
[[nodiscard]] std::vector<io::Row<Placement>> placement_rows(const std::string& before, const std::string& of);

/// The same of a part of an object.
template <class T>
void add_placement(std::vector<io::Row<T>>& rows, Placement T::*part, const std::string& before,
                   const std::string& of) {
  for (io::Row<Placement>& row : placement_rows(before, of)) rows.push_back(io::of(part, std::move(row)));
}

}  // namespace robomill::robot
