#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/published/arcs.hpp"

namespace robomill::cutting::detail {

/// The patch of a ball that cuts a plane with nothing but the ball, by its border.
///
/// On the unit sphere of outward normals u in F, with the feed's pitch λ = l / R, side s of the neighbour and
/// c = 1 - h / R, the patch is u_z < -c, u_x > 0, λ² - 2 s λ u_y - u_x² > 0. A ring is u·a = -cos κ, a the tool's axis.
/// The border's three curves, divided where κ turns along them, cross a ring once each at most. The κ of their ends are
/// all at which arcs open, close, split, or change their bounds.
class BallPatch {
 public:
  /// Of a plane: no curvatures.
  BallPatch(double radius_m, const Cut& cut, const Eigen::Matrix3d& feed_from_tool);
  /// The angles of the ring κ that are in the cut.
  [[nodiscard]] ArcList arcs(double position_rad) const;
  /// κ between which arcs are smooth functions of it, in order.
  [[nodiscard]] const std::vector<double>& borders() const { return borders_; }

 private:
  /// A part of the border along which cos κ rises or falls.
  struct Branch {
    Bound bound = Bound::none;
    double from = 0.0, to = 0.0;  ///< of the curve's parameter
    double cosine_from = 0.0, cosine_to = 0.0;
  };
  [[nodiscard]] Eigen::Vector3d at(Bound bound, double parameter) const;
  [[nodiscard]] double cosine(Bound bound, double parameter) const { return -at(bound, parameter).dot(axis_); }
  [[nodiscard]] bool contains(const Eigen::Vector3d& normal) const;
  [[nodiscard]] double crossing(const Branch& branch, double cosine) const;
  void add_curve(Bound bound, double from, double to);

  Eigen::Matrix3d rotation_;
  Eigen::Vector3d axis_;
  double height_ = 0.0;  ///< c
  double width_ = 0.0;   ///< sqrt(1 - c²)
  double pitch_ = 0.0;   ///< λ; of a slot without bound
  double side_ = -1.0;
  std::vector<Branch> branches_;
  std::vector<double> borders_;
};

}  // namespace robomill::cutting::detail
