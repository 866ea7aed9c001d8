#pragma once
#include <filesystem>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// Decides the conditions of the job's program, judged already, and puts the decided program in the place of the one
/// that was read: forces, blocks, the trajectory and the program's text. Where no conditions keep every limit there is
/// neither text nor trajectory.
/// @param folder  as of run_job
void decide_conditions(PlanResult& result, const cell::Cell& cell, const process::DynamicsAt& dynamics,
                       const process::BlocksOptions& blocks, const std::filesystem::path& folder, Progress& progress);

}  // namespace robomill::jobs
