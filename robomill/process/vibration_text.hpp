#pragma once
#include <string>

#include "robomill/stability/forced_vibration.hpp"

namespace robomill::process {

/// "the tip moves 31 µm to either side of its mean position, 62 % of the feed per tooth. The largest part, 28 µm, is 2
/// × tooth passing (920.0 Hz), in which mode 3 (922.0 Hz) moves most".
/// @param share  of the feed per tooth
[[nodiscard]] std::string vibration_text(const stability::ForcedVibration& vibration, double share);

}  // namespace robomill::process
