#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "robomill/io/stl.hpp"
#include "robomill/robot/collision.hpp"

namespace robomill::robot {

/// A closed mesh around a solid of revolution about z: its facets touch the solid and stand off at most `excess_m` at
/// their edges; more where that took above 256 facets (radii above 0.27 m at 20 µm).
/// @param outline  by height, no height falling, not all radii 0
[[nodiscard]] io::TriangleMesh revolve(const std::vector<OutlinePoint>& outline, double excess_m);

/// A convex solid of revolution about z by the half-planes of its outline. A point at radius r and height z has
///     depth = min_i (c_i − a_i r − b_i z),    a_i >= 0, (a_i, b_i) the outward normals
/// which inside is its distance to the surface. Each term is concave in space, so is their least: over a triangle its
/// tangents are upper bounds, and a search by sections finds its greatest value.
class ConvexRevolution {
 public:
  /// @param outline      as CellGeometry::validate wants it
  /// @param beyond_top_m  the plane at the top counts as surface this far above it
  ConvexRevolution(const std::vector<OutlinePoint>& outline, double beyond_top_m);

  [[nodiscard]] double depth_m(const Eigen::Vector3d& at_m) const;
  /// At least the greatest depth in a box. @param half_m  its half axes, by column
  [[nodiscard]] double bound_over_box_m(const Eigen::Vector3d& center_m, const Eigen::Matrix3d& half_m) const;
  /// The greatest depth over a triangle to 0.1 µm, where that is above `above_m`; else anything up to above_m.
  [[nodiscard]] double most_over_triangle_m(const std::array<Eigen::Vector3d, 3>& corners_m, double above_m) const;
  /// The point of the axis that is deepest, and how deep it is.
  [[nodiscard]] const Eigen::Vector3d& deepest_m() const { return deepest_m_; }
  [[nodiscard]] double greatest_depth_m() const { return greatest_depth_m_; }

 private:
  struct HalfPlane {
    double outward = 0.0, up = 0.0, offset_m = 0.0;  ///< a, b, c
  };
  /// The least of the tangents' greatest values over center + offsets.
  template <class Extent>
  double bound(const Eigen::Vector3d& center_m, Extent&& extent) const;

  std::vector<HalfPlane> sides_;
  Eigen::Vector3d deepest_m_ = Eigen::Vector3d::Zero();
  double greatest_depth_m_ = 0.0;
};

}  // namespace robomill::robot
