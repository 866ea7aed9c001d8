#pragma once
#include <vector>

#include "robomill/modal/posture/flexible_arm.hpp"
#include "robomill/modal/posture/smoothed_frf.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::modal::detail {

/// Where spindle and tool vibrate on the flange: peaks of the receptance across the tool's axis, in flange axes, that
/// stay while the arm's own modes move from posture to posture. At most three, the highest first, with the mass that
/// each has.
[[nodiscard]] std::vector<FlexibleArm::Tool> tool_peaks(const robot::Cell& cell, const std::vector<PostureData>& data,
                                                        double highest_hz);

}  // namespace robomill::modal::detail
