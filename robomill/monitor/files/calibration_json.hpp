#pragma once
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/monitor/calibration.hpp"

namespace robomill::monitor {

/// calibration.json: status and, where it is not "found", the reason; threshold and direction, both halves with their
/// ROC curves, every recording.
[[nodiscard]] const io::Schema<Calibration>& calibration_table();
[[nodiscard]] std::string calibration_json(const Calibration& calibration);

}  // namespace robomill::monitor
