#pragma once
#include "robomill/report/monitor.hpp"

namespace robomill::report {

/// Two channels of a tooth passing into which a growing tone breaks, as a recorder saw them, and a calibration.
[[nodiscard]] MonitorRun sample_monitor();
[[nodiscard]] CalibrationRun sample_calibration();

}  // namespace robomill::report
