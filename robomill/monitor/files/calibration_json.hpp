#pragma once
#include <string>

#include "robomill/monitor/calibration.hpp"

namespace robomill::monitor {

/// What a calibration found as JSON text: its status and, where it is not "found", the reason; threshold and direction,
/// both halves with their ROC curves, every recording.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);

}  // namespace robomill::monitor
