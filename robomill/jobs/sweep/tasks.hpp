#pragma once
#include <string>
#include <vector>

#include "robomill/jobs/files/slurm_jobs.hpp"
#include "robomill/jobs/sweep.hpp"

namespace robomill::jobs {

/// @param there    which chunks of the study are done
/// @param running  shards that processes work at, "3/16", for where Slurm says nothing
[[nodiscard]] SweepTasks tasks_of(const SlurmJobs& jobs, const std::vector<bool>& there,
                                  const std::vector<std::string>& running);

}  // namespace robomill::jobs
