#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/dexels/workpiece_kernel.hpp"
#include "robomill/program/program.hpp"

namespace robomill::cutting {

/// Of a ray's coordinate; empty where from > to.
struct Span {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();
  [[nodiscard]] bool empty() const { return !(from < to); }
};

/// A convex body of revolution swept along a line with its axis held. A ray meets it in one span, since the sweep is
/// convex: with q = p + t u - λ d the body at λ = 0, the first t that the ray meets is a convex function of λ, so its
/// least value over [0, 1] stands at that of the endless sweep, or at the end of [0, 1] nearest to it.
class SweptSolid {
 public:
  /// Ball about `center`.
  static SweptSolid ball(const Eigen::Vector3d& center, double radius, const Eigen::Vector3d& way);
  /// Cylinder from height `low` to `high` above `tip`.
  static SweptSolid cylinder(const program::Pose& pose, double low, double high, double radius,
                             const Eigen::Vector3d& way);
  /// Whatever outline.
  static SweptSolid convex(const program::Pose& pose, const Profile& profile, const Eigen::Vector3d& way);

  /// Fixes the direction of the rays that follow: 0, 1, 2.
  void aim(int axis);
  /// Where eight rays of a row meet the sweep: their coordinates across (columns, and that of the row).
  void meet(double row, const Lanes& columns, std::array<Span, lane_count>& spans) const;
  /// The same of a cylinder about it, which is cheaper where `exact_about` is false: never less than meet.
  void about(double row, const Lanes& columns, std::array<Span, lane_count>& spans) const;
  [[nodiscard]] bool exact_about() const { return kind_ != Kind::convex; }
  /// One ray of what `about` has found.
  [[nodiscard]] Span refine(double row, double column, const Span& about) const;
  /// Range of columns that rays of one row may meet.
  [[nodiscard]] Span columns(double row) const;
  /// Range of a coordinate.
  [[nodiscard]] Span extent(int axis) const;
  /// At most the area that it covers, seen from any side.
  [[nodiscard]] double silhouette_m2() const;
  /// How far a point lies within the swept cylinder, from its side [m].
  [[nodiscard]] double depth_in_side(const Eigen::Vector3d& point) const;

 private:
  enum class Kind { ball, cylinder, convex };
  /// A line or an arc of a convex outline: normals from (s0, c0) to (s1, c1), (sin κ, cos κ), about a centre.
  struct Facet {
    double r = 0.0, z = 0.0, arc = 0.0, s0 = 0.0, c0 = 0.0, s1 = 0.0, c1 = 0.0;
  };
  /// What a ray brings, but for its part along the axis across it.
  struct Ray {
    double ww = 0.0, wu = 0.0, wd = 0.0, wz = 0.0;
  };
  SweptSolid(Kind kind, const Eigen::Vector3d& origin, const Eigen::Vector3d& axis, double low, double high,
             double radius, const Eigen::Vector3d& way);

  struct Value {
    double f = 0.0, slope_t = 0.0, slope_lambda = 0.0;
  };
  [[nodiscard]] Value outline(const Ray& ray, double t, double lambda) const;
  [[nodiscard]] Value nearest_outline(const Ray& ray, double t, double close) const;

  Kind kind_;
  std::vector<Facet> facets_ = {};
  Eigen::Vector3d origin_, axis_, way_;
  double low_, high_, radius_;
  int ray_ = 2, column_ = 0, row_ = 1;  ///< axes
  detail::Meeting aimed_ = {};
};

/// The cutter at one held axis: edges, and the shank up to `top_m` above the tip.
struct SweptCutter {
  std::vector<SweptSolid> edges;
  std::vector<SweptSolid> shank;
};
[[nodiscard]] SweptCutter swept_cutter(const Profile& profile, const program::Pose& pose, const Eigen::Vector3d& way,
                                       double top_m);

}  // namespace robomill::cutting
