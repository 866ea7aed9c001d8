#include "robomill/monitor/speed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::monitor {
namespace {

constexpr std::array<double, SpeedSearch::windows> lengths_s = {0.1, 0.2, 0.4, 0.8};
constexpr double line_step = 0.25;  // of the spectrum's lines, at the highest harmonic
constexpr double around_hz = 30.0;  // to each side, that whitens; four lines at least
constexpr double highest = 5.0;     // of w

int highest_harmonic(int teeth) {
  return teeth > 0 ? 10 * teeth : 12;
}

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
  whiten(lines);
  teeth_ = teeth;
  high_hz_ = high_hz;
  next_hz_ = low_hz;
  step_hz_ = line_step * rate_hz_ / static_cast<double>(length_) / highest_harmonic(teeth);
  best_hz_ = 0.0;
  best_ = -1e9;
}

void SpeedSearch::whiten(std::size_t lines) noexcept {
  sums_[0] = 0.0;
  for (std::size_t k = 0; k < lines; ++k) {
    power_[k] = std::log(power_[k]);
    sums_[k + 1] = sums_[k] + power_[k];
  }
  const auto around =
      std::max<std::size_t>(4, static_cast<std::size_t>(around_hz / rate_hz_ * static_cast<double>(length_)));
  double total = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < lines; ++k) {
    const std::size_t from = k > around ? k - around : 0;
    const std::size_t to = std::min(lines, k + around + 1);
    const double mean = (sums_[to] - sums_[from]) / static_cast<double>(to - from);
    power_[k] = std::clamp(power_[k] - mean, 0.0, highest);
    total += power_[k];
    squares += power_[k] * power_[k];
  }
  mean_ = total / static_cast<double>(lines);
  deviation_ = std::sqrt(std::max(1e-6, squares / static_cast<double>(lines) - mean_ * mean_));
}

double SpeedSearch::whitened(double frequency_hz) const noexcept {
  const double at = frequency_hz / rate_hz_ * static_cast<double>(length_);
  const auto k = static_cast<std::size_t>(at);
  if (k + 1 > length_ / 2) return mean_;
  return std::lerp(power_[k], power_[k + 1], at - static_cast<double>(k));
}

double SpeedSearch::score(double rotation_hz) const noexcept {
  double sum = 0.0;
  double squares = 0.0;
  const int most = highest_harmonic(teeth_);
  for (int k = 1; k <= most && k * rotation_hz < 0.45 * rate_hz_; ++k) {
    const bool tooth = teeth_ == 0 || k % teeth_ == 0;
    if (!tooth && k > 4 * teeth_) continue;
    const double weight = tooth ? 1.0 : 0.35;
    sum += weight * (whitened(k * rotation_hz) - mean_);
    squares += weight * weight;
  }
  return squares > 0.0 ? sum / (deviation_ * std::sqrt(squares)) : 0.0;
}

bool SpeedSearch::advance(std::size_t candidates) noexcept {
  for (std::size_t i = 0; i < candidates && searching(); ++i, next_hz_ += step_hz_) {
    const double value = score(next_hz_);
    if (value > best_) {
      best_ = value;
      best_hz_ = next_hz_;
    }
  }
  return !searching();
}

}  // namespace robomill::monitor
