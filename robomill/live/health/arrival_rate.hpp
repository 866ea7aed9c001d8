#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace robomill::live {

/// The rate at which frames arrive, by the clock, against the one that they are said to be sampled at. Of a source that
/// cannot wait, since one that can arrives as fast as it is processed.
class ArrivalRate {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param longest_pause_s  without frames, after which it measures anew
  ArrivalRate(double sample_rate_hz, double longest_pause_s)
      : sample_rate_hz_(sample_rate_hz), longest_pause_s_(longest_pause_s) {}

  /// Frames that have arrived just now, those lost on their way among them. Measures over 10 s and more, from one
  /// arrival to another; not in the first 2 s, in which comes at once what had waited.
  /// @return the measured rate [Hz] where it is off by more than 10 %
  std::optional<double> add(std::uint64_t frames, Clock::time_point now);
  /// What is wrong, for people.
  [[nodiscard]] std::string message(double measured_hz) const;

 private:
  double sample_rate_hz_, longest_pause_s_;
  std::uint64_t frames_ = 0;
  bool begun_ = false, settled_ = false;
  Clock::time_point begin_ = {}, last_ = {};
};

}  // namespace robomill::live
