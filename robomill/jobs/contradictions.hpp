#pragma once
#include <string>
#include <vector>

#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"

/// What two files of one job say differently.
namespace robomill::jobs {

/// Keys that both files give, and with other values: teeth, diameter, helix, pitch and runout of the tool, coefficients
/// that are plain numbers; of a single cut its direction, radial depth and feed per tooth too.
/// @return a sentence each, for the user; empty of files that were built in memory
[[nodiscard]] std::vector<std::string> contradictions(const LobesFile& lobes, const process::ForcesFile& forces);

/// What job.toml and forces.toml say differently of the length of the edges.
[[nodiscard]] std::vector<std::string> contradictions(const Job& job, const process::ForcesFile& forces);

}  // namespace robomill::jobs
