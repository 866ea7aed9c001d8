#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <vector>

#include "robomill/io/stl.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/collision/inside.hpp"

namespace robomill::robot {

class ConvexRevolution;

/// A solid with what queries of its distance and of depths need: a tree of boxes over its triangles. Its queries may
/// run in several threads at once.
class Solid {
 public:
  explicit Solid(io::TriangleMesh mesh);
  explicit Solid(const Capsule& capsule);
  ~Solid();
  Solid(Solid&&) noexcept;
  Solid& operator=(Solid&&) = delete;
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  /// Distance to another solid, within_m where it is farther; 0 where they intersect or one is inside the other.
  /// @param other_pose  from the frame of `other` to this one's
  [[nodiscard]] double distance_m(const Solid& other, const Eigen::Isometry3d& other_pose, double within_m) const;
  /// At most the distance to another solid; cheap.
  [[nodiscard]] double bound_m(const Solid& other, const Eigen::Isometry3d& other_pose) const;
  /// How deep this solid's points stand in a convex solid of revolution, where that is more than above_m; else anything
  /// up to above_m.
  /// @param pose  from this solid's frame to that of `cutter`
  [[nodiscard]] double depth_in_m(const ConvexRevolution& cutter, const Eigen::Isometry3d& pose, double above_m) const;

  /// Edges of the mesh that belong to an odd number of triangles; 0: closed.
  [[nodiscard]] std::size_t open_edges() const { return open_edges_; }
  /// All of the solid is within this of a point, and within that of a line through the point.
  /// @param pose  from the solid's frame to one whose origin is the point
  /// @param line  unit
  [[nodiscard]] double farthest_m(const Eigen::Isometry3d& pose) const;
  [[nodiscard]] double farthest_m(const Eigen::Isometry3d& pose, const Eigen::Vector3d& line) const;

 private:
  struct Tree;
  [[nodiscard]] bool contains(const Eigen::Vector3d& at_m) const { return inside_ && inside_->inside(at_m); }
  /// Whether a piece of `other` begins inside. Of solids whose surfaces are apart: whether it is inside.
  [[nodiscard]] bool contains_piece(const Solid& other, const Eigen::Isometry3d& other_pose) const;

  std::unique_ptr<const io::TriangleMesh> mesh_;  // inside_ looks at it
  std::unique_ptr<const Tree> tree_;
  std::unique_ptr<const InsideTest> inside_;  // of a closed mesh
  std::size_t open_edges_ = 0;
  double rounding_m_ = 0.0;                // the solid is all within this of the mesh
  Eigen::AlignedBox3d box_;                // of the mesh
  double radius_m_ = 0.0;                  // of the mesh about the middle of the box
  std::vector<Eigen::Vector3d> pieces_m_;  // a vertex of each connected piece of the mesh
};

}  // namespace robomill::robot
