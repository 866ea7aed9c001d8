#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/monitor.hpp"

namespace robomill::monitor {

/// Validates the samples of one channel: puts finite ones in the place of others and reports faults.
class SignalValidation {
 public:
  explicit SignalValidation(const MonitorOptions& options);
  /// The sample to work with.
  double take(float sample) noexcept;
  /// Bits of Fault that the hop showed; a new hop begins.
  std::uint32_t hop_faults() noexcept;
  /// Mean square of the hop about its mean, from before hop_faults() began a new one.
  [[nodiscard]] double variance() const noexcept { return variance_; }
  /// Whether the channel has no usable signal: stuck, dead, or mostly not finite.
  [[nodiscard]] bool bad() const noexcept { return bad_; }
  void reset() noexcept;

 private:
  double full_scale_;
  std::size_t stuck_run_;
  double last_ = 0.0, sum_ = 0.0, squares_ = 0.0, offset_ = 0.0, variance_ = 0.0;
  double ever_low_ = 0.0, ever_high_ = 0.0, run_value_ = 0.0;
  std::size_t run_ = 0, longest_ = 0, count_ = 0, lost_ = 0, at_full_scale_ = 0, flat_tops_ = 0;
  bool first_ = true, moved_ = false, bad_ = false;
};

}  // namespace robomill::monitor
