#include "robomill/monitor/tachometer.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double extremes_memory_s = 2.0;  // of the extremes
constexpr double least_swing = 0.25;       // of the one of pulses that gave a speed
constexpr double hysteresis = 0.125;       // of their distance, below the middle
constexpr double stale_marks = 2.5;        // distances of marks without one
constexpr double least_std = 2e-4;         // of f: no shaft turns more evenly

}  // namespace

Tachometer::Tachometer(double sample_rate_hz, int pulses_per_revolution) noexcept : rate_hz_(sample_rate_hz) {
  const auto pulses = static_cast<std::size_t>(std::max(1, pulses_per_revolution));
  stride_ = std::max<std::size_t>(1, pulses / marks_a_turn);
  turns_a_mark_ = static_cast<double>(stride_) / static_cast<double>(pulses);
  used_ = std::min(kept, static_cast<std::size_t>(static_cast<double>(turns) / turns_a_mark_) + 1);
}

void Tachometer::reset() noexcept {
  low_ = high_ = last_ = time_ = pulse_ = swing_ = rotation_hz_ = std_ratio_ = 0.0;
  pulses_ = marks_ = 0;
  first_ = true;
  armed_ = false;
}

void Tachometer::push(std::span<const double> samples) noexcept {
  for (const double x : samples) {
    if (first_) low_ = high_ = last_ = x;
    first_ = false;
    forget_extremes(x);
    const double level = 0.5 * (low_ + high_);
    if (x < level - hysteresis * (high_ - low_)) armed_ = true;
    if (armed_ && x >= level && last_ < level) {
      pulse_ = time_ - (x - level) / (x - last_);
      if (pulses_++ % stride_ == 0) mark_[marks_++ % kept] = pulse_;
      armed_ = false;
    }
    last_ = x;
    time_ += 1.0;
  }
  regress();
}

void Tachometer::forget_extremes(double sample) noexcept {
  const double swing = high_ - low_;
  const double forget = swing > least_swing * swing_ ? 0.5 * swing / (extremes_memory_s * rate_hz_) : 0.0;
  low_ = std::min(sample, low_ + forget);
  high_ = std::max(sample, high_ - forget);
}

void Tachometer::regress() noexcept {
  rotation_hz_ = std_ratio_ = 0.0;
  const std::size_t n = std::min(marks_, used_);
  if (n < 2) return;
  const double newest = mark_[(marks_ - 1) % kept];
  const double middle = 0.5 * static_cast<double>(n - 1);
  double squares = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double place = static_cast<double>(i) - middle;
    squares += place * place;
    product += place * (mark_[(marks_ - n + i) % kept] - newest);
  }
  const double apart = product / squares;  // samples from mark to mark
  if (apart <= 0.0 || time_ - newest > stale_marks * apart) {
    marks_ = 0;
    return;
  }
  swing_ = high_ - low_;
  rotation_hz_ = rate_hz_ * turns_a_mark_ / apart;
  std_ratio_ = std::hypot(least_std, 1.0 / (std::sqrt(12.0 * squares) * apart));
}

}  // namespace robomill::monitor
