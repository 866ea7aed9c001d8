#include "robomill/live/health/load.hpp"

#include <algorithm>
#include <utility>

namespace robomill::live {

void Load::take(const Hop& hop, double stream_s, bool drained, Clock::time_point now) {
  const bool anew = std::exchange(anew_, false);
  if (std::exchange(drained_, drained)) {
    from_ = hop.arrived == Clock::time_point() ? now : hop.arrived;
    from_s_ = stream_s;
  } else if (anew) {
    from_ = now;
    from_s_ = stream_s;
  }
  const double passed_s = std::chrono::duration<double>(now - from_).count();
  ahead_s_ = stream_s - from_s_ - passed_s;
  behind_s_ = by_clock_ ? std::max(0.0, -ahead_s_) : 0.0;
  if (hop.dropped) whole_from_s_ = stream_s + look_back_s_;
  if (hop.dropped || behind_s_ > longest_s) {
    overloaded_ = true;
  } else if ((drained || behind_s_ < caught_up_s) && stream_s >= whole_from_s_) {
    overloaded_ = false;
  }
}

void Load::stalled() {
  overloaded_ = true;
  anew_ = ahead_s_ > caught_up_s;
}

}  // namespace robomill::live
