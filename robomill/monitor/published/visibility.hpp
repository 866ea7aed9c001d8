#pragma once
#include "robomill/monitor/calibration.hpp"

namespace robomill::monitor {

struct Visibility {
  double line_hz = unknown_s, visible_s = unknown_s;
};
/// When chatter's line becomes visible in the spectrogram, by the rule of calibrate(); NaN where it does not.
[[nodiscard]] Visibility visibility(const Recording& recording, const MonitorOptions& options);

}  // namespace robomill::monitor
