#include "robomill/live/load.hpp"

#include <algorithm>
#include <utility>

#include "robomill/monitor/monitor.hpp"

namespace robomill::live {

void Load::take(const Hop& hop, double stream_s, bool drained, Clock::time_point now) {
  if (std::exchange(drained_, drained)) {
    from_ = hop.arrived == Clock::time_point() ? now : hop.arrived;
    from_s_ = stream_s;
  }
  const double passed_s = std::chrono::duration<double>(now - from_).count();
  behind_s_ = by_clock_ ? std::max(0.0, passed_s - (stream_s - from_s_)) : 0.0;
  if (hop.dropped) whole_from_s_ = stream_s + monitor::ChatterMonitor::look_back_s;
  if (hop.dropped || behind_s_ > longest_s) {
    overloaded_ = true;
  } else if (drained && stream_s >= whole_from_s_) {
    overloaded_ = false;
  }
}

}  // namespace robomill::live
