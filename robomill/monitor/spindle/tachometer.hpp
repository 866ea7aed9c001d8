#pragma once
#include <cstddef>
#include <span>

namespace robomill::monitor {

/// Rotation from pulses once a revolution: upward crossings of the middle between the slowly forgotten extremes, with a
/// quarter of their distance as hysteresis, between samples by a straight line.
class Tachometer {
 public:
  explicit Tachometer(double sample_rate_hz) noexcept : rate_hz_(sample_rate_hz) {}
  void push(std::span<const double> samples) noexcept;
  /// Mean over the last pulses, up to four; 0: fewer than two, or none for two revolutions.
  [[nodiscard]] double rotation_hz() const noexcept;
  void reset() noexcept { *this = Tachometer(rate_hz_); }

 private:
  static constexpr std::size_t kept = 5;
  double rate_hz_;
  double low_ = 0.0, high_ = 0.0, last_ = 0.0, time_ = 0.0;  // time_: samples
  double pulse_[kept] = {};
  std::size_t pulses_ = 0;
  bool first_ = true, armed_ = false;
};

}  // namespace robomill::monitor
