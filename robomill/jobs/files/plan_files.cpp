#include "robomill/io/file.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

/// What an earlier run computed from modes that this one has not.
void remove_later_stages(const std::filesystem::path& folder) {
  for (const char* name : {"lobes.json", "smooth.json", "trajectory.csv", "blocks.csv", "blocks.json"})
    io::remove_file(folder / name);
}

constexpr const char* monitor_name = "monitor.toml";

/// The decided program and its monitor; without them what an earlier run left.
void write_decided(const std::filesystem::path& folder, const PlanResult& result) {
  if (!result.decision) return;
  if (result.program_out) {
    io::write_file(folder / result.program_name, result.program_out->text);
  } else {
    io::remove_file(folder / ("program" + result.job.program.extension().string()));
  }
  if (result.monitor) {
    io::write_file(folder / monitor_modes_name, result.monitor->modes_json);
    io::write_file(folder / monitor_name, result.monitor->toml);
  } else {
    for (const char* name : {monitor_modes_name, monitor_name}) io::remove_file(folder / name);
  }
}

/// What stands beside the report.
std::vector<page::StageFile> stage_files(const PlanResult& result) {
  std::vector<page::StageFile> files;
  if (result.frfs) {
    files.push_back(
        {.stage = "frf",
         .file = "tip.uff",
         .description = result.prediction ? "predicted FRFs, universal file 58" : "measured FRFs, universal file 58"});
  }
  if (result.job.has_structure())
    files.push_back({.stage = "modes", .file = "modes.json", .description = "modal parameters"});
  if (result.has_lobes()) {
    files.push_back({.stage = "lobes", .file = "lobes.json", .description = "stability lobes"});
  }
  if (result.forces) {
    files.push_back({.stage = "forces",
                     .file = "forces.csv",
                     .description = result.forces->program ? "cutting forces, a row a block of the program"
                                                           : "cutting forces over a revolution"});
  }
  if (result.blocks) {
    files.push_back({.stage = "blocks", .file = "blocks.csv", .description = "stability and load, a row a block"});
    files.push_back({.stage = "blocks", .file = "blocks.json", .description = "the same by columns"});
  }
  if (result.path) {
    files.push_back({.stage = "path", .file = "smooth.json", .description = "the smoothed program beside its limits"});
    if (result.path->smoothed.written) {
      files.push_back({.stage = "path",
                       .file = result.path->output.filename().string(),
                       .description = "joints and tool, a row a sample"});
    }
  }
  if (result.program_out) {
    files.push_back(
        {.stage = "plan", .file = result.program_name, .description = "the program at the decided speeds and feeds"});
  }
  files.push_back({.stage = "plan", .file = "plan.json", .description = "recommendation and every stage's result"});
  return files;
}

}  // namespace

void write_plan(const std::filesystem::path& folder, const PlanResult& result) {
  io::make_folder(folder);
  const io::Json plan = plan_object(result);
  const page::Report report = report_of(result, stage_files(result), plan);
  const std::string page = page::report_html(report);
  if (result.frfs) modal::write_frfs(folder / "tip.uff", *result.frfs);
  if (!report.modes.empty()) io::write_file(folder / "modes.json", report.modes);
  if (result.has_lobes()) {
    io::write_file(folder / "lobes.json", report.lobes);
  } else {
    remove_later_stages(folder);
  }
  if (result.forces) io::write_file(folder / "forces.csv", forces_csv(*result.forces));
  if (result.blocks) {
    io::write_file(folder / "blocks.csv", blocks_csv(*result.forces, *result.blocks));
    io::write_file(folder / "blocks.json", report.blocks);
  }
  write_decided(folder, result);
  if (result.path) {
    place(*result.path);
    io::write_file(folder / "smooth.json", report.smooth);
  }
  io::write_file(folder / "plan.json", plan_text(plan));
  io::write_file(folder / "report.html", page);
}

}  // namespace robomill::jobs
