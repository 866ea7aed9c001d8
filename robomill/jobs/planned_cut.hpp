#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// The jobs whose cut a document has: itself, where it is a job; else the documents beside it whose job.lobes names it,
/// as far as what their structures come from is there.
[[nodiscard]] std::vector<std::filesystem::path> jobs_of_cut(const std::filesystem::path& lobes);
/// A sentence that the structure of none of several jobs was taken.
[[nodiscard]] std::string several_jobs_text(const std::vector<std::filesystem::path>& jobs,
                                            const std::filesystem::path& lobes);
/// A sentence on how the structure by which a job plans the cut differs from that of its [dynamics]; empty where both
/// are one file of modes.
[[nodiscard]] std::string other_structure_text(const std::filesystem::path& job, const LobesFile& cut);

/// A cut as the plan of its job has it: its structure in place of what the file says, the range of the job's spindle in
/// place of the chart's, and a note that says so.
/// @param structure  of run_structure()
/// @throws InvalidInput as load_dynamics() of the workpiece
void take_plan(LobesFile& cut, const PlanResult& structure);

}  // namespace robomill::jobs
