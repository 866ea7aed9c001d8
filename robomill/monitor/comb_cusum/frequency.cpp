#include "robomill/monitor/comb_cusum/frequency.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/units.hpp"

namespace robomill::monitor {
namespace {

constexpr double hann_loss = 1.9;  // variance under the Hann window against the bound

}  // namespace

FrequencyRing::FrequencyRing(double sample_rate_hz, double longest_s)
    : rate_hz_(sample_rate_hz),
      ring_(2 * static_cast<std::size_t>(std::lround(longest_s * sample_rate_hz))),
      piece_(ring_.size() / 2),
      size_(ring_.size() / 2) {}

void FrequencyRing::reset() noexcept {
  std::fill(ring_.begin(), ring_.end(), 0.0F);
  at_ = 0;
}

void FrequencyRing::push(std::span<const float> samples) noexcept {
  for (const float x : samples) {
    ring_[at_] = ring_[at_ + size_] = x;
    at_ = at_ + 1 == size_ ? 0 : at_ + 1;
  }
}

double FrequencyRing::power(double frequency_hz, std::size_t first, std::size_t count) const noexcept {
  // Σ x_t z^t by Goertzel's recursion, in double.
  const double angle = units::revolution * frequency_hz / rate_hz_;
  const double c = 2.0 * std::cos(angle);
  double s1 = 0.0;
  double s2 = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    const double s = piece_[i] + c * s1 - s2;
    s2 = s1;
    s1 = s;
  }
  return s1 * s1 + s2 * s2 - c * s1 * s2;
}

double FrequencyRing::peak(double coarse_hz, double around_hz, std::size_t first, std::size_t count) const noexcept {
  const double resolution = rate_hz_ / static_cast<double>(count);
  const int steps = std::max(1, static_cast<int>(std::ceil(around_hz / (0.5 * resolution))));
  const double low = 0.5 * resolution;
  const double high = 0.5 * rate_hz_ - low;
  double best = -1.0;
  double at = coarse_hz;
  for (int i = -steps; i <= steps; ++i) {
    const double f = std::clamp(coarse_hz + i * 0.5 * resolution, low, high);
    const double p = power(f, first, count);
    if (p > best) {
      best = p;
      at = f;
    }
  }
  // The log of the main lobe is nearly a parabola; three times, each finer.
  double step = 0.5 * resolution;
  for (int i = 0; i < 3; ++i) {
    const double before = std::log(power(at - step, first, count) + 1e-300);
    const double here = std::log(power(at, first, count) + 1e-300);
    const double after = std::log(power(at + step, first, count) + 1e-300);
    const double bend = before - 2.0 * here + after;
    if (bend < 0.0) at = std::clamp(at + step * std::clamp(0.5 * (before - after) / bend, -1.0, 1.0), low, high);
    step *= 0.3;
  }
  return at;
}

FrequencyEstimate FrequencyRing::estimate(double coarse_hz, double around_hz, double length_s) noexcept {
  const std::size_t n = std::clamp<std::size_t>(static_cast<std::size_t>(length_s * rate_hz_), 32, size_);
  const float* last = ring_.data() + at_ + size_ - n;
  const auto window = [&](std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const double w =
          0.5 - 0.5 * std::cos(units::revolution * (static_cast<double>(i) + 0.5) / static_cast<double>(count));
      piece_[first + i] = w * static_cast<double>(last[first + i]);
    }
  };
  const std::size_t half = n / 2;
  window(0, half);
  window(n - half, half);
  const double resolution = rate_hz_ / static_cast<double>(n);
  const double late = peak(coarse_hz, around_hz, n - half, half);
  const double early = peak(late, 2.0 * resolution, 0, half);
  window(0, n);
  FrequencyEstimate out;
  out.frequency_hz = peak(0.5 * (early + late), std::max(resolution, 0.5 * std::abs(late - early)), 0, n);
  const double count = static_cast<double>(n);
  out.amplitude = 4.0 / count * std::sqrt(std::max(0.0, power(out.frequency_hz, 0, n)));
  double noise = 0.0;
  double looked = 0.0;
  for (int i = 4; i <= 8; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double f = out.frequency_hz + side * i * resolution;
      if (f <= resolution || f >= 0.5 * rate_hz_ - resolution) continue;
      noise += power(f, 0, n) / (count * 0.375);  // Σ w² of the Hann window is 3n/8
      looked += 1.0;
    }
  }
  const double variance = looked > 0.0 ? noise / looked : 0.0;
  const double bound =
      hann_loss * 24.0 * variance / (std::max(1e-300, out.amplitude * out.amplitude) * count * count * count);
  // Each half's own deviation is √8 of the whole's.
  const double known = std::sqrt(bound) * rate_hz_ / units::revolution;
  const double drift = std::max(0.0, std::abs(late - early) - 4.0 * known) / 3.0;
  out.std_hz = std::hypot(known, drift);
  return out;
}

}  // namespace robomill::monitor
