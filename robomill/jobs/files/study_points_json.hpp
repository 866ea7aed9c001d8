#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/jobs/sweep/shown_points.hpp"

namespace robomill::jobs {

/// Points of a study, for its page alone.
[[nodiscard]] const io::Schema<ShownPoints>& study_points_table();

}  // namespace robomill::jobs
