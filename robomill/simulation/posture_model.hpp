#pragma once
#include "robomill/simulation/cut_model.hpp"
#include "robomill/simulation/posture.hpp"

namespace robomill::simulation::detail {

/// In the tool frame; a ring for each range of angles of each slice.
[[nodiscard]] CutModel posture_model(const PostureCut& cut, int steps_per_revolution);

/// Mean angle between entry and exit, by width; a revolution where nothing cuts.
[[nodiscard]] double mean_arc_rad(const cutting::Engagement& engagement);

}  // namespace robomill::simulation::detail
