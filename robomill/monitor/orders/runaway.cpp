#include "robomill/monitor/orders/runaway.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"

namespace robomill::monitor {
namespace {

constexpr double least_rise_per_s = 20.0;  // of ln E
constexpr double enough_s = 0.1, stands_s = 0.2;
constexpr double as_before = 0.6;  // of the mean rise
constexpr double least_line_share = 0.3;
constexpr double same_hz = 20.0;

}  // namespace

Runaway::Runaway(double hop_s) noexcept
    : hop_s_(hop_s),
      enough_hops_(std::max<std::size_t>(2, hops_of(enough_s, hop_s))),
      standing_hops_(std::max<std::size_t>(2, hops_of(stands_s, hop_s))) {}

bool Runaway::step(double frequency_hz, double energy, double share) noexcept {
  const double log_energy = std::log(energy + 1e-300);
  const double rise = log_energy - log_energy_;
  const bool same = std::abs(frequency_hz - frequency_hz_) < same_hz;
  log_energy_ = log_energy;
  frequency_hz_ = frequency_hz;
  if (left_ > 0) --left_;
  if (share > least_line_share && rise > least_rise_per_s * hop_s_ && same) {
    ++hops_;
    risen_ += rise;
    if (hops_ >= enough_hops_ && rise > as_before * risen_ / static_cast<double>(hops_)) left_ = standing_hops_;
  } else {
    hops_ = 0;
    risen_ = 0.0;
  }
  return left_ > 0 && share > least_line_share;
}

}  // namespace robomill::monitor
