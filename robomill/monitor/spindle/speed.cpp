#include "robomill/monitor/spindle/speed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::monitor {
namespace {

constexpr std::array<double, SpeedSearch::windows> lengths_s = {0.1, 0.2, 0.4, 0.8};
constexpr double line_step = 0.3;          // of the spectrum's lines, at the highest peak
constexpr double around_hz = 50.0;         // to each side, that a peak is held against; six lines at least
constexpr double least_excess = 2.0;       // of a peak's log power
constexpr double least_peak_share = 1e-5;  // of the greatest peak's power: below is the skirt of its window
constexpr double highest_peak_hz = 2500.0;
constexpr double tolerance = 0.6;  // lines
constexpr double other = 0.5;      // worth of a harmonic that is no multiple of the teeth

}  // namespace

SpeedSearch::SpeedSearch(double sample_rate_hz, std::size_t channels) : rate_hz_(sample_rate_hz), channels_(channels) {
  for (const double seconds : lengths_s) {
    const std::size_t n = std::size_t{1} << static_cast<unsigned>(std::lround(std::log2(seconds * sample_rate_hz)));
    windows_.push_back({n, kissfft<double>(n, false), std::vector<double>(n)});
    for (std::size_t i = 0; i < n; ++i) {
      windows_.back().shape[i] =
          0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    }
  }
  size_ = windows_.back().length;
  ring_.resize(channels * size_);
  power_.resize(size_ / 2 + 1);
  sums_.resize(size_ / 2 + 2);
  in_.resize(size_);
  out_.resize(size_);
}

void SpeedSearch::reset() noexcept {
  std::fill(ring_.begin(), ring_.end(), 0.0F);
  at_ = 0;
  next_hz_ = 1.0;
  high_hz_ = best_hz_ = best_ = 0.0;
}

double SpeedSearch::window_s(std::size_t window) const noexcept {
  return static_cast<double>(windows_[window].length) / rate_hz_;
}

void SpeedSearch::push(std::span<const float> samples, std::size_t frames) noexcept {
  for (std::size_t i = 0; i < frames; ++i) {
    for (std::size_t c = 0; c < channels_; ++c) ring_[c * size_ + at_] = samples[c * frames + i];
    at_ = at_ + 1 == size_ ? 0 : at_ + 1;
  }
}

void SpeedSearch::last(std::size_t channel, std::span<float> out) const noexcept {
  std::size_t from = (at_ + size_ - out.size()) % size_;
  for (float& x : out) {
    x = ring_[channel * size_ + from];
    from = from + 1 == size_ ? 0 : from + 1;
  }
}

void SpeedSearch::begin(std::size_t window, double low_hz, double high_hz, int teeth) noexcept {
  Window& w = windows_[window];
  length_ = w.length;
  const std::size_t lines = length_ / 2 + 1;
  std::fill_n(power_.begin(), lines, 1e-30);
  const std::size_t first = (at_ + size_ - length_) % size_;
  // Two real channels to one complex transform.
  for (std::size_t c = 0; c < channels_; c += 2) {
    const float* even = ring_.data() + c * size_;
    const float* odd = c + 1 < channels_ ? even + size_ : nullptr;
    for (std::size_t i = 0, from = first; i < length_; ++i, from = from + 1 == size_ ? 0 : from + 1) {
      in_[i] = {w.shape[i] * static_cast<double>(even[from]), odd ? w.shape[i] * static_cast<double>(odd[from]) : 0.0};
    }
    w.fft.transform(in_.data(), out_.data());
    for (std::size_t k = 1; k < lines; ++k) power_[k] += 0.5 * (std::norm(out_[k]) + std::norm(out_[length_ - k]));
  }
  teeth_ = teeth;
  find_peaks(lines);
  high_hz_ = high_hz;
  next_hz_ = low_hz;
  double highest = low_hz;
  for (std::size_t i = 0; i < found_; ++i) highest = std::max(highest, peaks_[i].frequency_hz);
  const double line_hz = rate_hz_ / static_cast<double>(length_);
  // A low speed has more harmonics.
  step_ = line_step * line_hz / highest;
  freedom_ = std::log(std::max(2.0, std::log(high_hz / low_hz) / step_ * line_step / tolerance));
  best_hz_ = 0.0;
  best_ = -1e9;
}

void SpeedSearch::find_peaks(std::size_t lines) noexcept {
  sums_[0] = 0.0;
  const double greatest = *std::max_element(power_.begin() + 1, power_.begin() + static_cast<std::ptrdiff_t>(lines));
  const double least = std::log(least_peak_share * greatest);
  for (std::size_t k = 0; k < lines; ++k) {
    power_[k] = std::log(power_[k]);
    sums_[k + 1] = sums_[k] + power_[k];
  }
  const double line_hz = rate_hz_ / static_cast<double>(length_);
  const auto around = std::max<std::size_t>(6, static_cast<std::size_t>(around_hz / line_hz));
  const std::size_t last = std::min(lines - 1, static_cast<std::size_t>(highest_peak_hz / line_hz));
  found_ = 0;
  for (std::size_t k = 2; k < last; ++k) {
    if (power_[k] < least || power_[k] < power_[k - 1] || power_[k] <= power_[k + 1]) continue;
    const std::size_t from = k > around ? k - around : 1;
    const std::size_t to = std::min(lines, k + around + 1);
    const double excess = power_[k] - (sums_[to] - sums_[from]) / static_cast<double>(to - from);
    if (excess < least_excess) continue;
    const double bend = power_[k - 1] - 2.0 * power_[k] + power_[k + 1];
    const double off = bend < 0.0 ? 0.5 * (power_[k - 1] - power_[k + 1]) / bend : 0.0;
    const Peak peak = {(static_cast<double>(k) + off) * line_hz, std::min(excess - 1.5, 4.0)};
    if (found_ < most_peaks) {
      peaks_[found_++] = peak;
    } else {
      Peak& lowest = *std::min_element(peaks_.begin(), peaks_.end(),
                                       [](const Peak& a, const Peak& b) { return a.weight < b.weight; });
      if (lowest.weight < peak.weight) lowest = peak;
    }
  }
  weight_ = 0.0;
  double squares = 1e-300;
  for (std::size_t i = 0; i < found_; ++i) {
    weight_ += peaks_[i].weight;
    squares += peaks_[i].weight * peaks_[i].weight;
  }
  count_ = weight_ * weight_ / squares;
}

double SpeedSearch::score(double rotation_hz) const noexcept {
  if (found_ == 0 || rotation_hz <= 0.0) return -1e9;
  const double reach_hz = tolerance * rate_hz_ / static_cast<double>(length_);
  const double teeth = std::max(1, teeth_);
  const double least = teeth > 1.0 ? other : 1.0;
  double explained = 0.0;
  for (std::size_t i = 0; i < found_; ++i) {
    const double order = peaks_[i].frequency_hz / rotation_hz;
    const double multiple = std::max(1.0, std::round(order));
    const double near = 1.0 - std::abs(order - multiple) * rotation_hz / reach_hz;
    if (near > 0.0) explained += peaks_[i].weight * near * (std::fmod(multiple, teeth) == 0.0 ? 1.0 : least);
  }
  const double share = std::clamp(explained / weight_, 1e-6, 1.0 - 1e-6);
  const double chance = std::min(0.9, reach_hz / rotation_hz * (1.0 / teeth + least * (1.0 - 1.0 / teeth)));
  if (share <= chance) return -freedom_;
  return count_ * (share * std::log(share / chance) + (1.0 - share) * std::log((1.0 - share) / (1.0 - chance))) -
         freedom_;
}

bool SpeedSearch::advance(std::size_t candidates) noexcept {
  for (std::size_t i = 0; i < candidates && searching(); ++i, next_hz_ *= 1.0 + step_) {
    const double value = score(next_hz_);
    if (value > best_) {
      best_ = value;
      best_hz_ = next_hz_;
    }
  }
  return !searching();
}

}  // namespace robomill::monitor
