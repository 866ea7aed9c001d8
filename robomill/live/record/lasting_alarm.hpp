#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_events.hpp"

namespace robomill::live {

/// An alarm with what its decisions and their advice say of it while it lasts.
struct LastingAlarm {
  RecordedAlarm alarm = {};     ///< its std is infinite while that of its frequency is not known
  double advised_std_hz = NAN;  ///< of the frequency that the advice is for

  /// Why it began; frequencies and the surest of them.
  /// @param channels  their names
  void note(const monitor::Decision& decision, const std::vector<std::string>& channels);
  /// The advice for the surest frequency. False: there is none, or one for a surer frequency stays.
  bool advise(const monitor::MonitorEvent& event);
};

}  // namespace robomill::live
