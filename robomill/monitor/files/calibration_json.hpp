#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/monitor/published/calibrate.hpp"

namespace robomill::formats {

/// What a calibration found as JSON text: threshold and direction, both halves with their ROC curves, every recording.
[[nodiscard]] ROBOMILL_API std::string calibration_json(const monitor::Calibration& calibration);

}  // namespace robomill::formats
