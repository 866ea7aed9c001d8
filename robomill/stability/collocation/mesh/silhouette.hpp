#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/cutter.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

/// A place of the cutter whose outward normal is square to the feed.
struct SilhouettePoint {
  cutting::Profile::Point on_profile;  ///< with its own κ
  double angle_rad = 0.0;              ///< φ in T
  Eigen::Vector3d normal;              ///< (0, sin ψ, -cos ψ), in F
  Eigen::Vector3d position_m;          ///< in F, from the cutter's lowest point
};

/// What a cutter sweeps along x_F has the outline of these places: with a the axis in F and A² = a_y² + a_z² the
/// normals of the ring κ that are square to x_F have cos κ = a_z cos ψ - a_y sin ψ = A cos(ψ + δ), one on either side.
class Silhouette {
 public:
  Silhouette(const cutting::Profile& profile, const Eigen::Matrix3d& feed_from_tool);

  /// A part of the profile along which places of the silhouette move smoothly.
  struct Stretch {
    enum class Kind { line, arc, corner } kind = Kind::line;  ///< a corner: one place of the profile, many κ
    cutting::Profile::Point first, last;
    double arc_radius_m = 0.0;
    /// Of a line its share in [0, 1], else κ.
    [[nodiscard]] cutting::Profile::Point at(double parameter) const;
  };
  /// None where the feed runs along the axis. A flat bottom that the feed runs along has no part in it, nor a corner
  /// that stays where it is: it leaves an edge and no surface.
  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  /// Parameters along a stretch whose places are on the silhouette, in order, φ and κ no further apart than the steps.
  [[nodiscard]] std::vector<double> parameters(const Stretch& stretch, int side, double angle_step_rad,
                                               double line_share) const;
  /// @param side  1: towards y_F, -1: away from it
  [[nodiscard]] SilhouettePoint at(const cutting::Profile::Point& point, int side) const;
  /// φ of the ring κ on a side; NaN where it has no place on the silhouette.
  [[nodiscard]] double angle_rad(double position_rad, int side) const;

 private:
  [[nodiscard]] Eigen::Vector3d normal(double position_rad, int side) const;

  Eigen::Matrix3d turn_;
  Eigen::Vector3d lowest_m_ = Eigen::Vector3d::Zero();
  double reach_ = 1.0;      ///< A
  double shift_rad_ = 0.0;  ///< δ
  double least_rad_ = 0.0;  ///< κ where both sides meet
  std::vector<Stretch> stretches_;
};

/// The lower outline of a silhouette over y: what a neighbouring pass has taken or will take.
class Outline {
 public:
  explicit Outline(const Silhouette& silhouette);
  /// Whether (y, z) lies within what the cutter sweeps.
  [[nodiscard]] bool covers(double y_m, double z_m) const;

 private:
  struct Node {
    double y_m = 0.0, z_m = 0.0;
    double slope = 0.0;  ///< dz/dy
  };
  std::vector<Node> nodes_;  ///< y increasing
};

}  // namespace robomill::stability::detail
