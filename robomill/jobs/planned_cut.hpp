#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/plan.hpp"

// Method: robomill/jobs/README.md, "Cuts of a job (`planned_cut.hpp`)"

namespace robomill::jobs {

/// The job whose cut a lobes.toml is: the one document beside it whose job.lobes names it. None where none or several
/// do, or where what the job's structure comes from is not there.
[[nodiscard]] ROBOMILL_API std::optional<std::filesystem::path> job_of_cut(const std::filesystem::path& lobes);

/// A cut as the plan of its job has it: its structure in place of what the file says, the range of the job's spindle in
/// place of the chart's, and a note that says so.
/// @param structure  of run_structure()
/// @throws InvalidInput as load_dynamics() of the workpiece
ROBOMILL_API void take_plan(LobesFile& cut, const PlanResult& structure);

}  // namespace robomill::jobs
