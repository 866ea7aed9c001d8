#pragma once
#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/regime.hpp"

namespace robomill::stability::detail {

/// Of a case on the border of stability or beyond.
/// @param factor  what its stiffness is multiplied by
RegimeResult regime_of(const LobesProblem& problem, const CollocationCase& at, double factor,
                       double spindle_speed_rad_per_s, double chatter_frequency_hz);

}  // namespace robomill::stability::detail
