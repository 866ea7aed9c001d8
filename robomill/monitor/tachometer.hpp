#pragma once
#include <array>
#include <cstddef>
#include <span>

namespace robomill::monitor {

/// Rotation from the pulses of a tachometer or encoder, of either polarity: upward crossings of the middle between the
/// slowly forgotten extremes, with a quarter of their distance as hysteresis, between samples by a straight line. The
/// extremes are forgotten down to a quarter of the distance at which the speed was known last: noise makes no pulses
/// while the shaft rests. The
/// speed is the slope of pulses over time, by least squares over the last four turns. A pulse is seen to a sample, as
/// if its time were spread evenly over it: with n marks, m pulses apart, its deviation is
///   σ_f/f = σ_t/(T √Σ(i - mean i)²),   σ_t = 1/√12 sample, T the time between marks.
class Tachometer {
 public:
  Tachometer(double sample_rate_hz, int pulses_per_revolution) noexcept;
  void push(std::span<const double> samples) noexcept;
  /// 0: fewer than two marks, or none for two and a half times their distance, after which counting begins anew.
  [[nodiscard]] double rotation_hz() const noexcept { return rotation_hz_; }
  /// Since the last pulse [s]; 0: there was none yet.
  [[nodiscard]] double quiet_s() const noexcept { return pulses_ > 0 ? (time_ - pulse_) / rate_hz_ : 0.0; }
  [[nodiscard]] double std_ratio() const noexcept { return std_ratio_; }
  void reset() noexcept;

 private:
  static constexpr std::size_t turns = 4, marks_a_turn = 8, kept = turns * marks_a_turn + 1;

  void forget_extremes(double sample) noexcept;
  void regress() noexcept;

  double rate_hz_;
  std::size_t stride_ = 1;  // pulses from mark to mark
  double turns_a_mark_ = 1.0;
  std::size_t used_ = kept;                                  // marks in four turns
  double low_ = 0.0, high_ = 0.0, last_ = 0.0, time_ = 0.0;  // time_: samples
  double pulse_ = 0.0;                                       // time of the last one
  double swing_ = 0.0;                                       // between the extremes when the speed was known last
  std::array<double, kept> mark_ = {};                       // times; a ring
  std::size_t pulses_ = 0, marks_ = 0;
  bool first_ = true, armed_ = false;
  double rotation_hz_ = 0.0, std_ratio_ = 0.0;
};

}  // namespace robomill::monitor
