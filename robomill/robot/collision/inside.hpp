#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robomill/io/stl.hpp"

namespace robomill::robot {

/// How many edges of a mesh belong to an odd number of triangles; 0: it is closed.
[[nodiscard]] std::size_t open_edges(const io::TriangleMesh& mesh);

/// Whether points are inside a closed mesh: a ray along z meets an odd number of triangles. Each edge is tested with
/// the same numbers for both triangles that it belongs to, so that a ray through it meets one of them.
class InsideTest {
 public:
  /// @param mesh  closed; kept by reference
  explicit InsideTest(const io::TriangleMesh& mesh);
  [[nodiscard]] bool inside(const Eigen::Vector3d& at_m) const;

 private:
  [[nodiscard]] bool meets(const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& at_m) const;
  /// First and last bin of a triangle along x or y.
  [[nodiscard]] int bin(int axis, double at_m) const;
  bool sort_into_bins(std::size_t most_entries);

  const io::TriangleMesh& mesh_;
  Eigen::AlignedBox3d box_;
  int across_ = 1;                      ///< bins along x, and along y
  std::vector<std::size_t> begin_;      ///< of each bin in entries_, and the end
  std::vector<std::uint32_t> entries_;  ///< triangles
};

}  // namespace robomill::robot
