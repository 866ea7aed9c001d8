#pragma once
// Solids that tests and benchmarks share, and STL files of them.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/io/stl.hpp"

namespace robomill::robot::testing {

/// A box between two corners, its triangles turned outwards.
inline io::TriangleMesh box(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
  io::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_m.emplace_back((i & 1) != 0 ? to_m.x() : from_m.x(), (i & 2) != 0 ? to_m.y() : from_m.y(),
                                 (i & 4) != 0 ? to_m.z() : from_m.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A sphere of 20 · 4^times triangles, its vertices on the sphere.
inline io::TriangleMesh sphere(const Eigen::Vector3d& center_m, double radius_m, int times) {
  const double g = std::numbers::phi;
  io::TriangleMesh mesh;
  mesh.vertices_m = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int k = 0; k < times; ++k) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, first] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices_m.size()));
      if (first) mesh.vertices_m.emplace_back((mesh.vertices_m[a] + mesh.vertices_m[b]) / 2.0);
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Eigen::Vector3d& vertex : mesh.vertices_m) vertex.normalize();
  }
  for (Eigen::Vector3d& vertex : mesh.vertices_m) vertex = center_m + radius_m * vertex.normalized();
  return mesh;
}

/// How far the facets of a sphere's mesh are within the sphere.
inline double facets_within_m(const io::TriangleMesh& mesh, const Eigen::Vector3d& center_m, double radius_m) {
  double out = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d normal =
        (mesh.vertices_m[b] - mesh.vertices_m[a]).cross(mesh.vertices_m[c] - mesh.vertices_m[a]).normalized();
    out = std::max(out, radius_m - std::abs(normal.dot(mesh.vertices_m[a] - center_m)));
  }
  return out;
}

inline io::TriangleMesh moved(io::TriangleMesh mesh, const Eigen::Isometry3d& pose) {
  for (Eigen::Vector3d& vertex : mesh.vertices_m) vertex = pose * vertex;
  return mesh;
}

/// Triangles of no particular order, in a cube of the given half size.
inline io::TriangleMesh random_triangles(Random& random, int count, double half_m, double size_m) {
  io::TriangleMesh mesh;
  const auto within = [&](double half) -> Eigen::Vector3d {
    const double x = random.uniform(-half, half), y = random.uniform(-half, half);
    return {x, y, random.uniform(-half, half)};
  };
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d at = within(half_m);
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (int i = 0; i < 3; ++i) mesh.vertices_m.emplace_back(at + within(size_m));
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

inline void append_little_endian(std::string& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xffU));
}

/// A binary STL. @param unit_m  of the file
inline std::string binary_stl(const io::TriangleMesh& mesh, double unit_m = 1e-3, std::string header = "part") {
  header.resize(80, ' ');
  std::string out = header;
  append_little_endian(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    out.append(12, '\0');
    for (const std::uint32_t vertex : triangle) {
      for (const double coordinate : mesh.vertices_m[vertex]) {
        append_little_endian(out, std::bit_cast<std::uint32_t>(static_cast<float>(coordinate / unit_m)));
      }
    }
    out.append(2, '\0');
  }
  return out;
}

}  // namespace robomill::robot::testing
