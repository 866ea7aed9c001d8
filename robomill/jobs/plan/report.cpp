#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/path/files/motion_json.hpp"

namespace robomill::jobs {

page::Report make_report(const PlanResult& result, const std::vector<page::StageFile>& files) {
  return report_of(result, files, plan_object(result));
}

page::Report report_of(const PlanResult& result, const std::vector<page::StageFile>& files, const io::Json& plan) {
  page::Report report;
  if (!result.job.title.empty()) report.title = result.job.title;
  report.created = created_now();
  report.summary = summary(result);
  if (result.frfs) report.frf = result.hits ? modal::frf_json(*result.hits) : modal::frf_json(*result.frfs);
  if (result.frfs && result.fit) report.fitted = modal::frf_json(fitted_frfs(result.fit->model, *result.frfs));
  if (result.prediction) report.assembly = io::dump(plan.at("assembly"));
  if (result.prediction && result.prediction->measured) report.measured = modal::frf_json(*result.prediction->measured);
  report.plan = io::dump(decision_json(result));
  if (plan.contains("modes")) report.modes = io::dump(plan.at("modes"));
  const modal::ModalModel& workpiece = result.cut.problem.workpiece_dynamics;
  if (!workpiece.modes.empty()) report.workpiece_modes = modal::modes_json(workpiece);
  if (result.has_lobes()) report.lobes = io::dump(plan.at("lobes"));
  if (!result.recordings.empty()) report.recordings = io::dump(recordings_table().write(result));
  const PlannedProgram& shown = result.shown();
  if (shown.forces) report.forces = io::dump(plan.at("forces"));
  if (shown.blocks) report.blocks = process::blocks_json(*shown.forces, *shown.blocks);
  if (shown.path) {
    report.smooth = io::dump(plan.at("path"));
    report.motion = path::motion_json(shown.path->outline, shown.path->motions);
  }
  report.assumed = result.assumed;
  report.files = files;
  return report;
}

}  // namespace robomill::jobs
