#include "robomill/monitor/comb_cusum/narrowband_detector.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double dominant = 0.15, alone = 0.4;  // shares with and without a comb
constexpr double rising = 0.25, risen = 2.0;    // of ln P, in a hop and in all
constexpr std::size_t enough_hops = 3;          // hops
constexpr double rings_off = 0.5;               // of the greatest power
constexpr std::size_t width = 2;                // lines by which what grows fast wanders

}  // namespace

bool NarrowbandDetector::step(const Hop& hop) noexcept {
  const double log_power = std::log(hop.power);
  const double rise = log_power - log_power_;
  const bool same = hop.line + width >= line_ && hop.line <= line_ + width;
  if (hop.comb_known != comb_known_) hops_ = 0;
  if (hop.line == 0 || hop.share < (hop.comb_known ? dominant : alone) || (!hop.comb_known && rise < rising)) {
    hops_ = 0;
    rise_ = 0.0;
  } else if (!same) {
    hops_ = hop.comb_known ? 1 : 0;
    rise_ = 0.0;
  } else {
    if (!hop.falls) ++hops_;
    rise_ += rise;
  }
  comb_known_ = hop.comb_known;
  line_ = hop.line;
  log_power_ = log_power;
  top_ = hops_ <= 1 ? hop.power : std::max(top_, hop.power);
  if (hop.power < rings_off * top_) hops_ = 0;
  if (hop.comb_known) return hops_ >= enough_hops;
  return (hops_ > enough_hops && rise_ > risen && !hop.may_be_the_cut) ||
         (hops_ > enough_hops + 1 && rise_ > 2.0 * risen && rise > 2.0 * rising);
}

}  // namespace robomill::monitor
