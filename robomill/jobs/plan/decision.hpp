#pragma once
#include <filesystem>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// Decides the conditions of the job's program, judged already: `decision`, and where it found conditions `decided`.
/// The program as it is loses its trajectory.
/// @param folder  as of run_job
void decide_conditions(PlanResult& result, const cell::Cell& cell, const process::DynamicsAt& dynamics,
                       const process::BlocksOptions& blocks, const std::filesystem::path& folder, Progress& progress);

}  // namespace robomill::jobs
