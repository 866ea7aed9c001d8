#pragma once
#include <array>

#include "robomill/io/json.hpp"
#include "robomill/path/files/smooth_json.hpp"

namespace robomill::path {

/// smooth.json, for a file of its own and for plan.json. @throws InvalidInput if there is no method
[[nodiscard]] io::Json smooth_object(const SmoothedProgram& smoothed);

/// How a program's start was chosen: "posture" of smooth.json and of cell.json's placements.
[[nodiscard]] io::Json posture_object(const PostureChoice& choice, int joints, const std::array<bool, 6>& prismatic);

}  // namespace robomill::path
