#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/published/arcs.hpp"
#include "robomill/cutting/published/ball_patch.hpp"
#include "robomill/cutting/published/swept_silhouette.hpp"

namespace robomill::cutting::detail {

/// A ring of the envelope in F: center + sine sin φ + cosine cos φ.
struct Ring {
  Eigen::Vector3d center, sine, cosine;
  [[nodiscard]] Eigen::Vector3d at(double angle) const {
    return center + sine * std::sin(angle) + cosine * std::cos(angle);
  }
};

/// Where a cutter cuts: the conditions of engage() on each of its rings.
class Patch {
 public:
  /// Both have been validated.
  Patch(const Cutter& cutter, const Cut& cut);
  Patch(const Patch&) = delete;  // the silhouette refers to the profile
  Patch& operator=(const Patch&) = delete;
  [[nodiscard]] const Profile& profile() const { return profile_; }
  [[nodiscard]] const Eigen::Matrix3d& feed_from_tool() const { return rotation_; }
  /// The angles in the cut.
  [[nodiscard]] ArcList arcs(const Profile::Point& point) const;
  /// The angles below the unmachined surface.
  [[nodiscard]] ArcList below_surface(const Profile::Point& point) const;
  /// Whether a cylinder from this height above the tip up would cut.
  [[nodiscard]] bool reaches_from(double height_m) const;
  /// Where the cutter touches the finished surface: s.
  [[nodiscard]] double touching_length_m() const { return touching_.length_m; }
  /// Where only the ball of a ball end cuts a plane: the patch by its border, which arcs() then uses.
  [[nodiscard]] const std::optional<BallPatch>& ball() const { return ball_; }
  /// Places s that surely lie in the patch or on its border.
  [[nodiscard]] std::vector<double> places() const;

 private:
  enum class Neighbour { none, upright, ball, silhouette };
  void add_neighbour(const Cut& cut, bool is_ball, bool flat);
  [[nodiscard]] Ring ring(const Profile::Point& point) const;
  [[nodiscard]] ArcList outside_neighbour(const Profile::Point& point, const ArcList& within) const;
  [[nodiscard]] ArcList outside_ball(const Ring& ring, const ArcList& within) const;
  [[nodiscard]] double room_above(double sideways, double z) const;
  [[nodiscard]] Eigen::Vector2d seen_by_neighbour(const Eigen::Vector2d& point) const;

  Profile profile_;
  Cut cut_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  ///< of T, in F
  Extreme touching_;
  double ball_radius_ = 0.0;
  double side_ = 0.0;                                            ///< of the neighbouring pass: -1 at -y, 1 at +y
  Eigen::Vector2d neighbour_origin_ = Eigen::Vector2d::Zero();   ///< where it touches, in y and z
  Eigen::Vector2d neighbour_normal_ = Eigen::Vector2d::UnitY();  ///< of the finished surface there
  Neighbour neighbour_ = Neighbour::none;
  std::unique_ptr<SweptSilhouette> silhouette_;
  std::optional<BallPatch> ball_;
};

}  // namespace robomill::cutting::detail
