#pragma once
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

/// What all earlier edges left, at angles one time step apart; for a mill only where it cuts and two nodes beyond.
///
/// An edge that now stands out_m beyond the nominal circle with the feed at feed_m has before it
///   h = out - node.out + d g(φ) + (d cos φ)² / 2R,  d = feed - node.feed,
/// with g = sin φ for a mill (the last term is what an earlier circle falls back beside its own direction) and the
/// axial part of the chip's direction for a drill.
class Surface {
 public:
  explicit Surface(const CutModel& model);

  /// What a rigid cutter that turns evenly has left when the rotation is 0.
  void set_rigid();
  void scale_vibration(double factor);

  [[nodiscard]] double base_rad() const { return base_; }
  [[nodiscard]] double step_rad() const { return step_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] double sine(int ring, int node) const { return sine_[index(ring, node)]; }
  [[nodiscard]] double cosine(int ring, int node) const { return cosine_[index(ring, node)]; }
  [[nodiscard]] double offset_rad(int ring) const { return offset_[static_cast<std::size_t>(ring)]; }
  [[nodiscard]] Node& node(int ring, int node) { return nodes_[index(ring, node)]; }

  /// Between nodes by a straight line; position in nodes from the ring's first.
  [[nodiscard]] Node at(int ring, double position) const {
    const int k = static_cast<int>(position);
    const double f = position - k;
    const Node& a = nodes_[index(ring, k)];
    const Node& b = nodes_[index(ring, k + 1)];
    return {a.out_m + f * (b.out_m - a.out_m), a.feed_m + f * (b.feed_m - a.feed_m),
            a.vibration_m + f * (b.vibration_m - a.vibration_m)};
  }
  /// The terms of h that come with the feed.
  [[nodiscard]] double fed(double feed_m, const Node& node, double sine, double cosine) const {
    const double d = feed_m - node.feed_m;
    if (model_.whole_circle) return d * model_.axial;
    const double across = d * cosine;
    return d * (sine > 0.0 ? sine : 0.0) + across * across * inverse_diameter_;
  }

 private:
  [[nodiscard]] std::size_t index(int ring, int node) const {
    if (node >= count_) node -= model_.whole_circle ? count_ : node - count_ + 1;
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(count_) + static_cast<std::size_t>(node);
  }
  const CutModel& model_;
  double step_ = 0.0, base_ = 0.0, inverse_diameter_ = 0.0;
  int count_ = 0;
  std::vector<double> offset_;  ///< of a ring's first node [rad]
  std::vector<double> sine_, cosine_;
  std::vector<Node> nodes_;
};

}  // namespace robomill::simulation::detail
