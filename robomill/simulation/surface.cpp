#include "robomill/simulation/surface.hpp"

#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::simulation::detail {
template <int D>
Surface<D>::Surface(const CutModel& model)
    : model_(model),
      step_(units::revolution / model.steps_per_revolution),
      feed_per_revolution_m_(model.feed_m_per_s * units::revolution / model.spindle.mean_rad_per_s) {
  strips_.reserve(model.rings.size());
  std::size_t size = 0;
  for (const Ring& ring : model.rings) {
    Strip& strip = strips_.emplace_back();
    strip.first = size;
    strip.whole_circle = ring.whole_circle;
    strip.offset_rad = ring.whole_circle ? 0.0 : ring.entry_rad - 2.0 * step_;
    strip.count = ring.whole_circle ? model.steps_per_revolution
                                    : static_cast<int>(std::ceil((ring.exit_rad - ring.entry_rad) / step_)) + 6;
    size += static_cast<std::size_t>(strip.count);
  }
  // Where the ring's first element stands at the steps' ends: most elements then find nodes, and nothing is blurred.
  for (auto element = model.elements.rbegin(); element != model.elements.rend(); ++element) {
    const auto r = static_cast<std::size_t>(element->ring);
    if (model.rings[r].whole_circle) continue;
    const double base = model.rings[r].entry_rad - 2.0 * step_;
    const double steps = (element->standing_rad - base) / step_;
    double rest = steps - std::floor(steps);
    if (rest > 1.0 - 1e-9) rest = 0.0;
    strips_[r].offset_rad = base + (rest - (rest > 1e-9 ? 1.0 : 0.0)) * step_;
  }
  sine_.resize(size);
  cosine_.resize(size);
  nodes_.resize(size);
  for (std::size_t r = 0; r < strips_.size(); ++r) {
    Strip& strip = strips_[r];
    strip.entry = (model.rings[r].entry_rad - strip.offset_rad) / step_;
    strip.exit = (model.rings[r].exit_rad - strip.offset_rad) / step_;
    for (int k = 0; k < strip.count; ++k) {
      const double angle = strip.offset_rad + k * step_;
      sine_[strip.index(k)] = std::sin(angle);
      cosine_[strip.index(k)] = std::cos(angle);
    }
  }
}

template <int D>
void Surface<D>::set_rigid() {
  const double metres_per_rad = model_.feed_m_per_s / model_.spindle.speed(0.0);
  std::vector<bool> seen(nodes_.size(), false);
  for (const Element& element : model_.elements) {
    const Ring& ring = model_.rings[static_cast<std::size_t>(element.ring)];
    const Strip& on = strip(element.ring);
    for (int k = 0; k < on.count; ++k) {
      const double ahead = element.standing_rad - (on.offset_rad + k * step_);
      double since = ahead - units::revolution * std::floor(ahead / units::revolution);
      // An edge still reads the node behind it: that it passed there is left for it to say.
      if (since < step_ * (1.0 - 1e-7)) since += units::revolution;
      const std::size_t i = on.index(k);
      const Node mine = {element.radius_m, -since * metres_per_rad, 0.0};
      const double ours = mine.out_m - behind(ring, 0.0, mine, sine_[i], cosine_[i]);
      const double theirs = nodes_[i].out_m - behind(ring, 0.0, nodes_[i], sine_[i], cosine_[i]);
      const bool later = mine.feed_m > nodes_[i].feed_m;
      if (!seen[i] || ours > theirs || (ours == theirs && later)) nodes_[i] = mine;
      seen[i] = true;
    }
  }
}

template <int D>
void Surface<D>::scale_vibration(double factor) {
  for (Node& node : nodes_) node.vibration_m *= factor;
}

template class Surface<2>;
template class Surface<3>;

}  // namespace robomill::simulation::detail
