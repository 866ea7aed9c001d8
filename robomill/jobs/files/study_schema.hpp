#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/jobs/sweep/study.hpp"

namespace robomill::jobs {

/// [study]
[[nodiscard]] const io::Schema<Study>& study_table();
/// [[vary]]
[[nodiscard]] const io::Schema<Variation>& vary_table();
/// [boundary]
[[nodiscard]] const io::Schema<BoundaryTask>& boundary_task_table();
/// [sensitivity]
[[nodiscard]] const io::Schema<SensitivityTask>& sensitivity_task_table();
/// [probability]
[[nodiscard]] const io::Schema<ProbabilityTask>& probability_task_table();
/// [slurm]
[[nodiscard]] const io::Schema<SlurmSettings>& slurm_table();

}  // namespace robomill::jobs
