#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/io/README.md, "Triangles"

namespace robomill::io {

/// A surface of triangles.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices_m = {};              ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles = {};  ///< places in vertices_m
};

/// Reads a binary or an ASCII STL. Corners at the same place become one vertex; triangles with two corners at one
/// place, which cover nothing, are left out. Normals are not read.
/// @param unit_m  what one of the file's units is [m], > 0: an STL does not say; 1e-3 for mm
/// @throws InvalidInput with the file, and the line or the triangle, if it is missing, above 512 MiB, no STL or not
/// whole, if it has no triangle, or a coordinate that is not finite or above 1 km
[[nodiscard]] ROBOMILL_API TriangleMesh read_stl(const std::filesystem::path& path, double unit_m = 1e-3);

}  // namespace robomill::io
