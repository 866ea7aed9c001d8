#include "robomill/stability/chart/lowest_crossing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace robomill::stability::detail {
namespace {

struct Sample {
  double at = 0.0, value = 0.0;  ///< ln of the radius
};

class LowestSearch {
 public:
  LowestSearch(const LookAlong& look, const CrossingOptions& options) : look_(look), options_(options) {}

  Crossing run(const std::vector<double>& marks) {
    for (std::size_t first = 0; first < marks.size() && !unstable_; first += options_.at_a_time) {
      const std::size_t size = std::min(options_.at_a_time, marks.size() - first);
      add(std::vector<double>(marks.begin() + static_cast<std::ptrdiff_t>(first),
                              marks.begin() + static_cast<std::ptrdiff_t>(first + size)));
    }
    look_under_peaks();
    const auto top = std::ranges::find_if(samples_, [](const Sample& s) { return s.value >= 0.0; });
    Crossing out;
    if (top == samples_.end()) return out;
    if (top == samples_.begin()) {
      out.status = Crossing::Status::at_start;
      out.at = top->at;
      finish(out);
      return out;
    }
    return refine(*(top - 1), *top);
  }

 private:
  /// Looks at these and keeps all samples in order.
  void add(const std::vector<double>& at) {
    for (std::size_t first = 0; first < at.size(); first += lane_count) {
      const std::span<const double> some = std::span(at).subspan(first, std::min(lane_count, at.size() - first));
      std::array<Outcome, lane_count> outcomes;
      look_(some, {.level = options_.coarse_level}, std::span(outcomes).first(some.size()));
      for (std::size_t i = 0; i < some.size(); ++i) {
        samples_.push_back({some[i], std::log(outcomes[i].spectral_radius)});
        unstable_ = unstable_ || outcomes[i].spectral_radius >= 1.0;
      }
    }
    std::ranges::sort(samples_, {}, &Sample::at);
  }

  /// Below the first unstable mark an island may hide between two stable ones: a smooth branch that grows and falls.
  void look_under_peaks() {
    constexpr double near_share = 0.5;  // of what it rises from its neighbours
    std::vector<double> more;
    for (std::size_t i = 1; i + 1 < samples_.size() && samples_[i].value < 0.0; ++i) {
      const Sample &a = samples_[i - 1], &b = samples_[i], &c = samples_[i + 1];
      if (b.value < a.value || b.value < c.value) continue;
      const double left = std::log(b.at / a.at);
      const double right = std::log(c.at / b.at);
      const double rise = (b.value - a.value) / left;
      const double fall = (c.value - b.value) / right;
      const double curvature = (fall - rise) / (left + right);
      const double slope = rise + curvature * left;
      const double top = curvature < 0.0 ? -0.5 * slope / curvature : 0.0;  // from b, in ln
      const double height = b.value + top * (slope + curvature * top);
      if (height < -near_share * (height - std::min(a.value, c.value))) continue;
      const double place = std::clamp(top, -0.9 * left, 0.9 * right);
      more.insert(more.end(), {std::sqrt(a.at * b.at), b.at * std::exp(place), std::sqrt(b.at * c.at)});
    }
    std::erase_if(more, [&](double at) {
      return std::ranges::any_of(samples_, [at](const Sample& s) { return std::abs(s.at - at) < 1e-6 * at; });
    });
    if (!more.empty()) add(more);
  }

  Crossing refine(Sample low, Sample high) {
    constexpr double apart = 1e-3;  // of the two places whose difference is the slope, in ln
    constexpr int most = 30;
    Crossing out;
    out.status = Crossing::Status::found;
    if (options_.cheap_lanes) {
      interpolate(low, high, out);
      finish(out);
      correct(out);
      if (std::abs(std::log(out.outcome.spectral_radius)) <= options_.tolerance) return out;
    }
    out.at = between(low, high);
    for (int i = 0; i < most; ++i) {
      const std::array<double, 2> places = {out.at, out.at * std::exp(apart)};
      std::array<Outcome, 2> outcomes;
      look_(places, {.level = options_.level}, outcomes);
      const double value = std::log(outcomes[0].spectral_radius);
      out.slope = (std::log(outcomes[1].spectral_radius) - value) / apart;
      if (std::abs(value) <= 0.2 * options_.tolerance || high.at - low.at < 1e-12 * high.at) break;
      (value < 0.0 ? low : high) = {out.at, value};
      const double newton = out.at * std::exp(-value / out.slope);
      // From two levels the bracket may end a little too early.
      const bool inside = newton > low.at * 0.999 && newton < high.at * 1.001;
      out.at = inside && i % 6 != 5 ? newton : std::sqrt(low.at * high.at);
    }
    finish(out);
    correct(out);
    return out;
  }

  /// From eight places within the bracket, which it narrows: a polynomial through the two on either side of the root.
  void interpolate(Sample& low, Sample& high, Crossing& out) {
    std::array<double, lane_count> places = {};
    std::array<Outcome, lane_count> outcomes;
    for (std::size_t i = 0; i < lane_count; ++i) {
      const double share = (static_cast<double>(i) + 0.5) / lane_count;
      places[i] = low.at * std::pow(high.at / low.at, share);
    }
    look_(places, {.level = options_.level}, outcomes);
    std::array<Sample, lane_count> seen;
    for (std::size_t i = 0; i < lane_count; ++i) seen[i] = {places[i], std::log(outcomes[i].spectral_radius)};
    const auto top = std::ranges::find_if(seen, [](const Sample& s) { return s.value >= 0.0; });
    const std::size_t above = static_cast<std::size_t>(top - seen.begin());
    if (above > 0) low = seen[above - 1];
    if (above < lane_count) high = seen[above];
    const std::size_t first = std::min(std::max<std::size_t>(above, 2) - 2, lane_count - 4);
    out.at = between(low, high);
    out.slope = (high.value - low.value) / std::log(high.at / low.at);
    double place = 0.0;  // ln of the root, by the inverse polynomial
    for (std::size_t i = first; i < first + 4; ++i) {
      double weight = 1.0;
      for (std::size_t j = first; j < first + 4; ++j) {
        if (j != i) weight *= -seen[j].value / (seen[i].value - seen[j].value);
      }
      place += weight * std::log(seen[i].at);
    }
    const double root = std::exp(place);
    if (root > low.at && root < high.at) out.at = root;
  }

  /// By the secant, in logarithms.
  [[nodiscard]] static double between(const Sample& low, const Sample& high) {
    const double share = std::clamp(-low.value / (high.value - low.value), 0.05, 0.95);
    return low.at * std::exp(share * std::log(high.at / low.at));
  }

  void finish(Crossing& out) {
    look_({&out.at, 1}, {.estimate = options_.estimate, .motion = true, .level = options_.level}, {&out.outcome, 1});
  }

  /// The finest level of the last look may differ from that of the search.
  void correct(Crossing& out) {
    for (int i = 0; i < 3 && out.slope != 0.0; ++i) {
      const double value = std::log(out.outcome.spectral_radius);
      if (std::abs(value) <= options_.tolerance || !(std::abs(value) < 0.1)) return;
      out.at *= std::exp(std::clamp(-value / out.slope, -0.05, 0.05));
      finish(out);
    }
  }

  const LookAlong& look_;
  const CrossingOptions& options_;
  std::vector<Sample> samples_;
  bool unstable_ = false;
};

}  // namespace

Crossing lowest_crossing(const LookAlong& look, const std::vector<double>& marks, const CrossingOptions& options) {
  return LowestSearch(look, options).run(marks);
}

}  // namespace robomill::stability::detail
