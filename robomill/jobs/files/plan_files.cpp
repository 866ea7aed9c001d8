#include "robomill/io/file.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/path/files/smooth_json.hpp"

namespace robomill::jobs {
namespace {

/// What an earlier run computed from modes that this one has not.
void remove_later_stages(const std::filesystem::path& folder) {
  for (const char* name : {"lobes.json", "smooth.json", "trajectory.csv"}) io::remove_file(folder / name);
}

}  // namespace

void write_plan(const std::filesystem::path& folder, const PlanResult& result) {
  io::make_folder(folder);
  std::vector<page::StageFile> files;
  if (result.frfs) {
    modal::write_frfs(folder / "tip.uff", *result.frfs);
    files.push_back(
        {.stage = "frf",
         .file = "tip.uff",
         .description = result.prediction ? "predicted FRFs, universal file 58" : "measured FRFs, universal file 58"});
  }
  io::write_file(folder / "modes.json", modes_json(result));
  files.push_back({.stage = "modes", .file = "modes.json", .description = "modal parameters"});
  if (result.has_lobes()) {
    io::write_file(folder / "lobes.json", lobes_json(result));
    files.push_back({.stage = "lobes", .file = "lobes.json", .description = "stability lobes"});
  } else {
    remove_later_stages(folder);
  }
  if (result.forces) {
    io::write_file(folder / "forces.csv", forces_csv(*result.forces));
    files.push_back({.stage = "forces",
                     .file = "forces.csv",
                     .description = result.forces->program ? "cutting forces, a row a block of the program"
                                                           : "cutting forces over a revolution"});
  }
  if (result.path) {
    files.push_back({.stage = "path", .file = "smooth.json", .description = "the smoothed program beside its limits"});
    if (result.path->smoothed.written) {
      files.push_back({.stage = "path",
                       .file = result.path->output.filename().string(),
                       .description = "joints and tool, a row a sample"});
    }
  }
  files.push_back({.stage = "plan", .file = "plan.json", .description = "recommendation and every stage's result"});
  const std::string page = page::report_html(make_report(result, files));
  if (result.path) {
    place(*result.path);
    io::write_file(folder / "smooth.json", path::smooth_json(result.path->smoothed));
  }
  io::write_file(folder / "plan.json", plan_json(result));
  io::write_file(folder / "report.html", page);
}

}  // namespace robomill::jobs
