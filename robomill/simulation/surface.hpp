#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "robomill/simulation/cut_model.hpp"

namespace robomill::simulation::detail {

/// The surface at one angle: how far out the edge stood that left it (its radius and what it vibrated, along the chip's
/// direction), and where the feed was then. In a linear cut the vibration stands apart.
struct Node {
  double out_m = 0.0;
  double feed_m = 0.0;
  double vibration_m = 0.0;
};

/// The nodes of a ring's angles, one time step apart.
struct Strip {
  double offset_rad = 0.0;         ///< of the first
  double entry = 0.0, exit = 0.0;  ///< positions, in nodes from the first
  int count = 0;
  bool whole_circle = false;  ///< the first follows the last
  std::size_t first = 0;      ///< in the tables of all rings

  [[nodiscard]] std::size_t index(int node) const {
    if (node >= count) node = whole_circle ? node - count : count - 1;
    return first + static_cast<std::size_t>(node);
  }
};

/// What all earlier edges left; of a ring that does not cut all round only where it cuts and two nodes beyond.
///
/// An edge that now stands out_m beyond the nominal ring with the feed at feed_m cuts
///   h = out - node.out + d (n·u),  d = feed - node.feed,
/// u the feed's direction: what the feed sweeps past a piece of the envelope, d (n·u) dA, adds up to the volume
/// removed. Of a cylinder fed along x that is d sin φ, and of a drill d times the axial part of n.
///
/// Which edge stood farthest out is told by the same terms. Where the feed runs along the envelope (n·u = 0) they would
/// keep a mark for ever: one older than a revolution also falls back by e² ((t·u)² / 2r_t + (m·u)² / 2r_m), e the feed
/// since then, r_t and r_m the envelope's radii of curvature along the cut t and the profile m.
template <int D>
class Surface {
 public:
  explicit Surface(const CutModel& model);

  /// What a rigid cutter that turns evenly has left when the rotation is 0.
  void set_rigid();
  void scale_vibration(double factor);

  [[nodiscard]] double step_rad() const { return step_; }
  [[nodiscard]] const Strip& strip(int ring) const { return strips_[static_cast<std::size_t>(ring)]; }
  [[nodiscard]] double sine(std::size_t index) const { return sine_[index]; }
  [[nodiscard]] double cosine(std::size_t index) const { return cosine_[index]; }
  [[nodiscard]] Node& node(std::size_t index) { return nodes_[index]; }

  /// Between nodes by a straight line; position in nodes from the strip's first.
  [[nodiscard]] Node at(const Strip& strip, double position) const {
    const int k = static_cast<int>(position);
    const double f = position - k;
    const Node& a = nodes_[strip.index(k)];
    const Node& b = nodes_[strip.index(k + 1)];
    return {a.out_m + f * (b.out_m - a.out_m), a.feed_m + f * (b.feed_m - a.feed_m),
            a.vibration_m + f * (b.vibration_m - a.vibration_m)};
  }
  /// The term of h that comes with the feed. Just beyond entry and exit, where n·u < 0, the feed brings nothing.
  [[nodiscard]] double fed(const Ring& ring, double feed_m, const Node& node, double sine, double cosine) const {
    const double d = feed_m - node.feed_m;
    if constexpr (D == 2) {
      return d * (sine > 0.0 ? sine : 0.0);
    } else {
      const Eigen::Vector3d& u = model_.feed_direction;
      const double ahead = ring.lateral * (u.x() * sine + u.y() * cosine) - ring.axial * u.z();
      return d * (ahead > 0.0 ? ahead : 0.0);
    }
  }
  /// How far the feed has brought the envelope before the surface since the node was left.
  [[nodiscard]] double behind(const Ring& ring, double feed_m, const Node& node, double sine, double cosine) const {
    const double older = std::max(0.0, feed_m - node.feed_m - feed_per_revolution_m_);
    double bend = 0.0;
    if constexpr (D == 2) {
      bend = cosine * cosine * ring.bend_around_per_m;
    } else {
      const Eigen::Vector3d& u = model_.feed_direction;
      const double around = u.x() * cosine - u.y() * sine;
      const double along = ring.axial * (u.x() * sine + u.y() * cosine) + ring.lateral * u.z();
      bend = ring.bend_around_per_m * around * around + ring.bend_along_per_m * along * along;
    }
    return fed(ring, feed_m, node, sine, cosine) + older * older * bend;
  }

 private:
  const CutModel& model_;
  double step_ = 0.0, feed_per_revolution_m_ = 0.0;
  std::vector<Strip> strips_;
  std::vector<double> sine_, cosine_;
  std::vector<Node> nodes_;
};

extern template class Surface<2>;
extern template class Surface<3>;

}  // namespace robomill::simulation::detail
