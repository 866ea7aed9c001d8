#pragma once
#include <cstdint>
#include <string>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// Speeds that the spindle has and the chart does not are searched too.
/// @return a sentence on it for the user; empty where the chart has them all
[[nodiscard]] std::string cover_spindle(LobesFile& cut, const decision::MachineLimits& recommend);

/// Lobes of the job's cut with the modes that were found, the recommendation, and what stands beside it: the band,
/// pairs of modes, the limit over feed direction, test cuts.
void choose_conditions(PlanResult& result, std::uint64_t seed, Progress& progress);

}  // namespace robomill::jobs
