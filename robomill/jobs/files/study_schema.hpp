#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/jobs/sweep/study.hpp"

namespace robomill::jobs {

/// [study]
[[nodiscard]] const io::Schema<Study>& study_table();
/// [[vary]]
[[nodiscard]] const io::Schema<Variation>& vary_table();

}  // namespace robomill::jobs
