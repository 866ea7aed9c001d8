#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "robomill/monitor/monitor.hpp"

namespace robomill::monitor {

/// One hop of samples, channel after channel: channel c has samples[c * frames] … samples[(c + 1) * frames - 1].
struct Hop {
  std::span<const double> samples;
  std::size_t frames = 0;
  std::uint64_t bad_channels = 0;  ///< bit c: dead, stuck or not finite, or no vibration; to be left out
  bool still = false;              ///< the spindle stands still: what begins now is no chatter
  [[nodiscard]] std::span<const double> channel(std::size_t c) const noexcept {
    return samples.subspan(c * frames, frames);
  }
};

/// What makes a decision out of each hop. Samples are finite.
class Detector {
 public:
  Detector() = default;
  virtual ~Detector() = default;
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;
  Detector(Detector&&) = delete;
  Detector& operator=(Detector&&) = delete;

  /// Fills all of `decision` but hop, time_s, level, changed and the faults of the input.
  virtual void decide(const Hop& hop, Decision& decision) noexcept = 0;
  virtual void set_spindle_speed(double rad_per_s) noexcept = 0;
  virtual void reset() noexcept = 0;
};

/// That of a monitor.
[[nodiscard]] const Detector& detector_of(const ChatterMonitor& monitor);

}  // namespace robomill::monitor
