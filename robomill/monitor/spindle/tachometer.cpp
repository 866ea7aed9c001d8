#include "robomill/monitor/spindle/tachometer.hpp"

#include <algorithm>

namespace robomill::monitor {

void Tachometer::push(std::span<const double> samples) noexcept {
  const double forget = 1.0 / (2.0 * rate_hz_);
  for (const double x : samples) {
    if (first_) low_ = high_ = last_ = x;
    first_ = false;
    const double middle = 0.5 * (low_ + high_);
    low_ = std::min(x, low_ + forget * (middle - low_));
    high_ = std::max(x, high_ + forget * (middle - high_));
    const double level = 0.5 * (low_ + high_);
    if (x < level - 0.125 * (high_ - low_)) armed_ = true;
    if (armed_ && x >= level && last_ < level) {
      pulse_[pulses_++ % kept] = time_ - (x - level) / (x - last_);
      armed_ = false;
    }
    last_ = x;
    time_ += 1.0;
  }
}

double Tachometer::rotation_hz() const noexcept {
  if (pulses_ < 2) return 0.0;
  const std::size_t turns = std::min(pulses_, kept) - 1;
  const double newest = pulse_[(pulses_ - 1) % kept];
  const double length = (newest - pulse_[(pulses_ - 1 - turns) % kept]) / static_cast<double>(turns);
  return length > 0.0 && time_ - newest < 2.5 * length ? rate_hz_ / length : 0.0;
}

}  // namespace robomill::monitor
