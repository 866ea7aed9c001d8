#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/jobs/lobes.hpp"

namespace robomill::jobs {

/// lobes.json: the chart, with the posture that its modes are of.
[[nodiscard]] const io::Schema<LobesJobResult>& lobes_json_table();

}  // namespace robomill::jobs
