#pragma once
#include <string>

#include "robomill/report/monitor.hpp"

namespace robomill::report {

/// Two channels of a tooth passing into which a growing tone breaks, as a recorder saw them.
/// @param message  of an event on the stream
[[nodiscard]] MonitorRun sample_monitor(const std::string& message = "2 blocks of the stream never came");
/// calibration.json of three recordings. @param name  of the first
[[nodiscard]] std::string sample_calibration(const std::string& name = "hole-001.wav");

}  // namespace robomill::report
