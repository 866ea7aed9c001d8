#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/published/arcs.hpp"

namespace robomill::cutting::detail {

/// A point of the outline that is furthest in a direction.
struct Extreme {
  double distance_m = 0.0;  ///< along that direction, from the tip
  Profile::Point at;
  double length_m = 0.0;  ///< s of the point
};
/// The point of the edges' envelope that is furthest along a unit vector with these parts across and along the axis;
/// across >= 0.
[[nodiscard]] Extreme extreme(const Profile& profile, double across, double along);

/// What a cutter sweeps along x, seen along x: its convex section with the plane of y and z, by its support function
/// H(u) = max p·u. The shank makes it endless towards the spindle, so u points at most square to the axis. Where the
/// side leans inwards the shank is narrower than the edges; there it is left out, and u may point anywhere.
class SweptSilhouette {
 public:
  /// @param feed_from_tool  R of P_F = origin + R P_T
  SweptSilhouette(const Profile& profile, const Eigen::Matrix3d& feed_from_tool, const Eigen::Vector3d& origin_m);
  /// Where the points of a ring, center + sine sin φ + cosine cos φ in y and z, are outside: where p·u > H(u) for some
  /// u. For each u that is one arc; the answer is the union over u, its ends the extremes of theirs.
  [[nodiscard]] ArcList outside(const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                                const Eigen::Vector2d& cosine) const;
  struct Tangent {
    Eigen::Vector2d direction;  ///< u
    Eigen::Vector2d point;      ///< of the section's border, in y and z
    double length_m = 0.0;      ///< s of the cutter's point there
  };
  /// The border where its outward normal u is at an angle from y towards z: from first_angle() on, for span().
  [[nodiscard]] Tangent tangent(double angle) const;
  [[nodiscard]] double first_angle() const { return first_angle_; }
  [[nodiscard]] double span() const { return undercut_ ? full_turn : 0.5 * full_turn; }
  [[nodiscard]] double support(const Eigen::Vector2d& direction) const;
  [[nodiscard]] bool contains(const Eigen::Vector2d& point) const;

 private:
  struct Reach;
  struct Run;
  [[nodiscard]] Reach reach(double angle, const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                            const Eigen::Vector2d& cosine) const;
  [[nodiscard]] BoundedArc sought(const Run& run, const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                                  const Eigen::Vector2d& cosine) const;
  [[nodiscard]] Extreme extreme_along(const Eigen::Vector2d& direction) const;
  const Profile* profile_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector2d origin_;
  bool undercut_ = false;
  double first_angle_ = 0.0;
  std::vector<Tangent> border_;  ///< at evenly spaced angles
};

}  // namespace robomill::cutting::detail
