#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"

// What run_job() is made of.

namespace robomill::jobs {

/// Decides the conditions of the job's program, judged already: `decision`, and where it found conditions `decided`.
/// The program as it is loses its trajectory.
/// @param folder  as of run_job
void decide_conditions(PlanResult& result, const cell::Cell& cell, const process::DynamicsAt& dynamics,
                       const process::BlocksOptions& blocks, const std::filesystem::path& folder, Progress& progress);

/// Speeds that the spindle has and the chart does not are searched too.
/// @return a sentence on it for the user; empty where the chart has them all
[[nodiscard]] std::string cover_spindle(LobesFile& cut, const decision::MachineLimits& recommend);

/// Lobes of the job's cut with the modes that were found, the recommendation, and what stands beside it: the band,
/// pairs of modes, the limit over feed direction, test cuts.
void choose_conditions(PlanResult& result, std::uint64_t seed, Progress& progress);

}  // namespace robomill::jobs
