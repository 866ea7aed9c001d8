#pragma once
#include <cmath>

#include "robomill/cutting/milling.hpp"

namespace robomill::stability::detail {

/// When the spindle stands at which angle: Ω(t) = Ω_0 (1 + A sin(r Ω_0 t)) turns by θ = Ω_0 t + A/r (1 - cos(r Ω_0 t)).
class Rotation {
 public:
  Rotation(double mean_rad_per_s, const cutting::SpeedVariation& variation)
      : mean_(mean_rad_per_s), amplitude_(variation.amplitude_ratio), ratio_(variation.frequency_ratio) {}

  [[nodiscard]] bool even() const { return amplitude_ == 0.0; }
  [[nodiscard]] double mean_rad_per_s() const { return mean_; }
  [[nodiscard]] double slowest_rad_per_s() const { return mean_ * (1.0 - amplitude_); }
  /// [s]
  [[nodiscard]] double time_s(double angle_rad) const { return (even() ? angle_rad : phase(angle_rad)) / mean_; }
  /// Ω at that angle [rad/s].
  [[nodiscard]] double speed_rad_per_s(double angle_rad) const {
    return even() ? mean_ : mean_ * (1.0 + amplitude_ * std::sin(ratio_ * phase(angle_rad)));
  }

 private:
  /// Ω_0 t. The angle grows steadily with it, at 1 - A at least, so that Newton's method with a halving in reserve
  /// ends.
  [[nodiscard]] double phase(double angle_rad) const {
    const double reach = 2.0 * amplitude_ / ratio_;
    double low = angle_rad - reach;
    double high = angle_rad;
    double x = angle_rad - 0.5 * reach;
    for (int i = 0; i < 100; ++i) {
      const double miss = x + amplitude_ / ratio_ * (1.0 - std::cos(ratio_ * x)) - angle_rad;
      (miss > 0.0 ? high : low) = x;
      double next = x - miss / (1.0 + amplitude_ * std::sin(ratio_ * x));
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      const bool there = std::abs(next - x) <= 1e-15 * (1.0 + std::abs(x));
      x = next;
      if (there) break;
    }
    return x;
  }

  double mean_, amplitude_, ratio_;
};

}  // namespace robomill::stability::detail
