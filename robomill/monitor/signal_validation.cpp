#include "robomill/monitor/signal_validation.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double stuck_s = 0.02;
constexpr std::size_t flat_top = 4;  // equal samples at the extreme that a converter's limit makes
// Of full scale, where that is known: what stands still below are the steps of a converter that has hardly a signal.
constexpr double least_limit = 0.01;

}  // namespace

SignalValidation::SignalValidation(const MonitorOptions& options)
    : full_scale_(options.full_scale),
      stuck_run_(std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(stuck_s * options.sample_rate_hz)))) {}

void SignalValidation::reset() noexcept {
  const double full_scale = full_scale_;
  const std::size_t stuck_run = stuck_run_;
  *this = SignalValidation(MonitorOptions{});
  full_scale_ = full_scale;
  stuck_run_ = stuck_run;
}

double SignalValidation::take(float sample) noexcept {
  const auto wide = static_cast<double>(sample);
  // Squares of more would overflow a float's range further on.
  const bool good = std::isfinite(wide) && std::abs(wide) < 1e15;
  const double x = good ? wide : last_;
  if (!good) ++lost_;
  if (first_ && good) {
    offset_ = ever_low_ = ever_high_ = x;
    run_value_ = x;
    first_ = false;
  }
  if (good) {
    if (x == run_value_) {
      ++run_;
    } else {
      moved_ = true;
      run_value_ = x;
      run_ = 1;
    }
    longest_ = std::max(longest_, run_);
    ever_low_ = std::min(ever_low_, x);
    ever_high_ = std::max(ever_high_, x);
    if (full_scale_ > 0.0 && std::abs(x) >= 0.9999 * full_scale_) ++at_full_scale_;
    const bool at_extreme = ever_high_ > ever_low_ && (x == ever_low_ || x == ever_high_);
    if (run_ == flat_top && at_extreme && std::abs(x) >= least_limit * full_scale_) ++flat_tops_;
  }
  last_ = x;
  ++count_;
  sum_ += x - offset_;
  squares_ += (x - offset_) * (x - offset_);
  return x;
}

std::uint32_t SignalValidation::hop_faults() noexcept {
  std::uint32_t faults = 0;
  const double n = static_cast<double>(std::max<std::size_t>(1, count_));
  const double mean = sum_ / n;
  variance_ = std::max(0.0, squares_ / n - mean * mean);
  offset_ += mean;
  if (lost_ > 0) faults |= not_finite;
  const bool stands = longest_ >= stuck_run_;
  if (stands) faults |= moved_ ? stuck : dead_channel;
  // Once is chance, or a channel that rests at its extreme.
  if (at_full_scale_ > 0 || (flat_tops_ > 1 && !stands)) faults |= clipped;
  bad_ = stands || 2 * lost_ > count_;
  longest_ = run_;
  count_ = lost_ = at_full_scale_ = flat_tops_ = 0;
  sum_ = squares_ = 0.0;
  return faults;
}

}  // namespace robomill::monitor
