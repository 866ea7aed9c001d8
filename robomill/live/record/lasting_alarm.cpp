#include "robomill/live/record/lasting_alarm.hpp"

#include <algorithm>
#include <cstddef>

namespace robomill::live {

void LastingAlarm::note(const monitor::Decision& decision, const std::vector<std::string>& channels) {
  if (alarm.why.test == monitor::Test::none) alarm.why = decision.why;
  if (decision.synchronous != monitor::SynchronousChatter::none) alarm.synchronous = decision.synchronous;
  const double frequency_hz = decision.chatter_frequency_hz;
  if (!(frequency_hz > 0.0)) return;
  alarm.low_frequency_hz = std::fmin(alarm.low_frequency_hz, frequency_hz);
  alarm.high_frequency_hz = std::fmax(alarm.high_frequency_hz, frequency_hz);
  const double std_hz = decision.chatter_frequency_std_hz > 0.0 ? decision.chatter_frequency_std_hz : HUGE_VAL;
  if (std_hz >= alarm.chatter_frequency_std_hz) return;
  alarm.chatter_frequency_hz = frequency_hz;
  alarm.chatter_frequency_std_hz = std_hz;
  const auto channel = static_cast<std::size_t>(std::max(decision.channel, 0));
  if (channel < channels.size()) alarm.channel = channels[channel];
}

bool LastingAlarm::advise(const monitor::MonitorEvent& event) {
  const bool advised =
      event.mode.known() || event.suggested_spindle_speed_rad_per_s > 0.0 || event.no_speed != monitor::NoSpeed::none;
  if (!advised || event.decision.chatter_frequency_std_hz >= advised_std_hz) return false;
  advised_std_hz = event.decision.chatter_frequency_std_hz;
  alarm.mode = event.mode;
  alarm.line_hz = event.line_hz;
  alarm.no_speed = event.no_speed;
  const double speed = event.suggested_spindle_speed_rad_per_s;
  alarm.suggested_spindle_speed_rad_per_s = speed > 0.0 ? speed : NAN;
  return true;
}

}  // namespace robomill::live
