#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/program/program.hpp"

/// What is left of the part while a program cuts it, in the work frame W.
// Method: robomill/cutting/README.md, "Workpiece (`workpiece.hpp`, `dexels/`)"
namespace robomill::cutting {

/// Material before the first cut.
struct ROBOMILL_API Stock {
  enum class Shape {
    box,       ///< from min_m to max_m, its sides along the axes of W
    cylinder,  ///< radius_m about the axis through center_m, from bottom_m to top_m
    turned     ///< outline_m turned about the axis through center_m; it gives bottom and top too
  };
  Shape shape = Shape::box;
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();     ///< box
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();     ///< box: above min_m in each direction
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();  ///< cylinder, turned: the axis, along z
  double radius_m = 0.0;                               ///< cylinder: > 0
  double bottom_m = 0.0;                               ///< cylinder
  double top_m = 0.0;                                  ///< cylinder: > bottom_m
  std::vector<Eigen::Vector2d> outline_m = {};         ///< turned: (r, z) from the bottom upwards, z never falling
  /// @throws InvalidInput naming the member
  void validate() const;
  /// Lowest corner of the box about it; valid stocks only.
  [[nodiscard]] Eigen::Vector3d lowest_m() const;
  /// Highest corner.
  [[nodiscard]] Eigen::Vector3d highest_m() const;
};

/// What one move took away.
struct ROBOMILL_API Removal {
  Eigen::Vector3d edges_m3 = Eigen::Vector3d::Zero();  ///< by the part with edges, as the rays along x, y, z see it
  Eigen::Vector3d shank_m3 = Eigen::Vector3d::Zero();  ///< by the shank, of what the edges have left
  Eigen::Vector3d silhouette_m2 = Eigen::Vector3d::Zero();  ///< area of the rays that it cut, by direction
  double shank_depth_m = 0.0;                               ///< how deep material stood in the shank
  /// Edges and shank together, mean of the directions weighed by the squares of their silhouettes: rays that meet the
  /// chip's faces at small angles are few and see its volume worst.
  [[nodiscard]] double volume_m3() const;
};

/// Material as intervals on rays along x, y and z, spaced by at most a dexel.
class ROBOMILL_API Workpiece {
 public:
  /// @param dexel_m  > 0; the grid fits the stock's box: each spacing divides its side, and spacing <= dexel_m
  /// @throws InvalidInput for bad stock, a dexel below 1 µm, or more rays than may be taken (base/cost.hpp)
  Workpiece(const Stock& stock, double dexel_m);
  ~Workpiece();
  Workpiece(Workpiece&&) noexcept;
  Workpiece& operator=(Workpiece&&) noexcept;

  /// Takes away what the cutter, with a shank of the last radius above it, passes from pose to pose. Along the tip's
  /// line the sweep is exact (the body is convex, so is its sweep). While the axis turns it is held over steps, at
  /// their middle, so short that no point of the edges stands more than half a dexel from its place, and none of the
  /// shank within the stock more than two.
  Removal remove(const Profile& cutter, const program::Pose& from, const program::Pose& to);

  /// How deep a point lies in material [m], negative outside, along the direction that sees the surface best, from the
  /// four rays about the point; cut off at ±3 dexels.
  [[nodiscard]] double depth_m(const Eigen::Vector3d& point_m) const;
  /// Whether a box stands so far off the stock's own that depth_m is farthest_m() at each of its points.
  [[nodiscard]] bool is_far_off(const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) const;
  [[nodiscard]] double farthest_m() const;           ///< where depth_m is cut off outside: -3 dexels
  [[nodiscard]] Eigen::Vector3d volumes_m3() const;  ///< as the rays along x, y and z see it
  [[nodiscard]] double dexel_m() const;              ///< largest of the three spacings
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace robomill::cutting
