#include <algorithm>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "robomill/io/system/folder_change.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/monitor/files/monitor_plan.hpp"

namespace robomill::jobs {
namespace {

constexpr const char *plan_name = "plan.json", *monitor_name = "monitor.toml";

/// A plan's documents in its folder, which change together.
class PlanFolder {
 public:
  explicit PlanFolder(const std::filesystem::path& folder) : folder_(folder), change_(folder) {}

  void write(const std::string& name, std::string_view content) {
    names_.push_back(name);
    change_.write(name, content);
  }
  /// Of a trajectory, or of that of an earlier run.
  void place(const process::SmoothResult& path) {
    const std::string name = path.output.filename().string();
    names_.push_back(name);
    if (path.trajectory) {
      change_.add(name, path.trajectory->finish());
    } else if (path.stale) {
      change_.remove(name);
    }
  }
  /// Takes away what an earlier run has written and this one has not.
  void commit(const std::string& program) {
    std::error_code ignored;
    const bool earlier = std::filesystem::is_regular_file(folder_ / plan_name, ignored);
    for (const std::string& name : {std::string("tip.uff"), std::string("modes.json"), std::string("lobes.json"),
                                    std::string("forces.csv"), std::string("blocks.csv"), std::string("blocks.json"),
                                    std::string("smooth.json"), std::string("trajectory.csv"),
                                    std::string(monitor::monitor_modes_name), std::string(monitor_name), program}) {
      if (earlier && !name.empty() && std::ranges::find(names_, name) == names_.end()) change_.remove(name);
    }
    change_.commit();
  }

 private:
  std::filesystem::path folder_;
  io::FolderChange change_;
  std::vector<std::string> names_;
};

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
  const PlannedProgram& shown = result.shown();
  if (shown.forces) {
    files.push_back({.stage = "forces",
                     .file = "forces.csv",
                     .description = shown.forces->program ? "cutting forces, a row a block of the program"
                                                          : "cutting forces over a revolution"});
  }
  if (shown.blocks) {
    files.push_back({.stage = "blocks", .file = "blocks.csv", .description = "stability and load, a row a block"});
    files.push_back({.stage = "blocks", .file = "blocks.json", .description = "the same by columns"});
  }
  if (shown.path) {
    files.push_back({.stage = "path", .file = "smooth.json", .description = "the smoothed program beside its limits"});
    if (shown.path->smoothed.written) {
      files.push_back({.stage = "path",
                       .file = shown.path->output.filename().string(),
                       .description = "joints and tool, a row a sample"});
    }
  }
  if (result.decided && result.decided->text) {
    files.push_back(
        {.stage = "plan", .file = result.decided->name, .description = "the program at the decided speeds and feeds"});
  }
  files.push_back({.stage = "plan", .file = "plan.json", .description = "recommendation and every stage's result"});
  return files;
}

}  // namespace

void write_plan(const std::filesystem::path& folder, const PlanResult& result) {
  const io::Json plan = plan_object(result);
  const page::Report report = report_of(result, stage_files(result), plan);
  const std::string page = page::report_html(report);
  PlanFolder files(folder);
  if (result.frfs) files.write("tip.uff", modal::frf_uff(*result.frfs));
  if (!report.modes.empty()) files.write("modes.json", report.modes);
  if (result.has_lobes()) files.write("lobes.json", report.lobes);
  const PlannedProgram& shown = result.shown();
  if (shown.forces) files.write("forces.csv", process::forces_csv(*shown.forces));
  if (shown.blocks) {
    files.write("blocks.csv", process::blocks_csv(*shown.forces, *shown.blocks));
    files.write("blocks.json", report.blocks);
  }
  if (result.decided && result.decided->text) files.write(result.decided->name, result.decided->text->text);
  if (result.decided && result.decided->monitor) {
    files.write(monitor::monitor_modes_name, result.decided->monitor->modes_json);
    files.write(monitor_name, result.decided->monitor->toml);
  }
  if (shown.path) {
    files.place(*shown.path);
    files.write("smooth.json", report.smooth);
  }
  files.write(plan_name, plan_text(plan));
  files.write("report.html", page);
  files.commit(result.job.program.empty() ? "" : "program" + result.job.program.extension().string());
}

}  // namespace robomill::jobs
