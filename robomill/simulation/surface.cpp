#include "robomill/simulation/surface.hpp"

#include <cmath>
#include <numbers>

namespace robomill::simulation::detail {
namespace {

constexpr double revolution = 2.0 * std::numbers::pi;

}  // namespace

Surface::Surface(const CutModel& model)
    : model_(model),
      step_(revolution / model.steps_per_revolution),
      inverse_diameter_(model.radius_m > 0.0 ? 0.5 / model.radius_m : 0.0) {
  base_ = model.whole_circle ? 0.0 : model.entry_rad - 2.0 * step_;
  count_ = model.whole_circle ? model.steps_per_revolution
                              : static_cast<int>(std::ceil((model.exit_rad - model.entry_rad) / step_)) + 6;
  const std::size_t size = static_cast<std::size_t>(model.rings) * static_cast<std::size_t>(count_);
  offset_.assign(static_cast<std::size_t>(model.rings), base_);
  sine_.resize(size);
  cosine_.resize(size);
  nodes_.resize(size);
  // Where the ring's first element stands at the steps' ends: most elements then find nodes, and nothing is blurred.
  if (!model.whole_circle) {
    for (auto element = model.elements.rbegin(); element != model.elements.rend(); ++element) {
      const double steps = (element->standing_rad - base_) / step_;
      double rest = steps - std::floor(steps);
      if (rest > 1.0 - 1e-9) rest = 0.0;
      offset_[static_cast<std::size_t>(element->ring)] = base_ + (rest - (rest > 1e-9 ? 1.0 : 0.0)) * step_;
    }
  }
  for (int r = 0; r < model.rings; ++r) {
    for (int k = 0; k < count_; ++k) {
      const double angle = offset_rad(r) + k * step_;
      sine_[index(r, k)] = std::sin(angle);
      cosine_[index(r, k)] = std::cos(angle);
    }
  }
}

void Surface::set_rigid() {
  const double metres_per_rad = model_.feed_m_per_s / model_.spindle.mean_rad_per_s;
  std::vector<bool> seen(nodes_.size(), false);
  for (const Element& element : model_.elements) {
    for (int k = 0; k < count_; ++k) {
      const double ahead = element.standing_rad - (offset_rad(element.ring) + k * step_);
      double since = ahead - revolution * std::floor(ahead / revolution);
      // An edge still reads the node behind it: that it passed there is left for it to say.
      if (since < step_ * (1.0 - 1e-7)) since += revolution;
      const std::size_t i = index(element.ring, k);
      const Node mine = {element.radius_m, -since * metres_per_rad, 0.0};
      const double ours = mine.out_m - fed(0.0, mine, sine_[i], cosine_[i]);
      const double theirs = nodes_[i].out_m - fed(0.0, nodes_[i], sine_[i], cosine_[i]);
      const bool later = mine.feed_m > nodes_[i].feed_m;
      if (!seen[i] || ours > theirs || (ours == theirs && later)) nodes_[i] = mine;
      seen[i] = true;
    }
  }
}

void Surface::scale_vibration(double factor) {
  for (Node& node : nodes_) node.vibration_m *= factor;
}

}  // namespace robomill::simulation::detail
