#include "robomill/serve/jobs/verb_runs.hpp"

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/cell/check.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/page/report.hpp"
#include "robomill/path/options.hpp"

namespace robomill::serve {
namespace {

template <class Result>
JobOutcome outcome_of(const Result& result) {
  using jobs::summary;  // a result may bring its own
  return {.shortfall = jobs::shortfall(result),
          .summary = summary(result),
          .report = page::report_json(jobs::page_of(result))};
}

/// Writes what was found where the job asks for it.
template <class Result>
JobOutcome finished(const VerbJob& job, const Result& result) {
  if (!job.output().empty()) jobs::write_document(job.output(), result);
  return outcome_of(result);
}

}  // namespace

JobOutcome run_plan(const VerbJob& job, Progress& progress) {
  const std::filesystem::path folder = job.output();
  const auto plan = std::make_shared<const jobs::PlanResult>(
      jobs::run_job(job.input(), job.seed(), progress, folder, job.flag("accept_fit")));
  const jobs::PlanResult& result = *plan;
  if (!folder.empty()) jobs::write_plan(folder, result);
  return {.shortfall = jobs::reached(result) ? "" : "no conditions within every limit were found",
          .summary = jobs::summary(result),
          .report = page::report_json(jobs::make_report(result, {})),
          .plan = result.judging ? plan : nullptr};
}

JobOutcome run_frf(const VerbJob& job, Progress& progress) {
  const jobs::FrfJobResult result = jobs::run_frf(job.input(), progress);
  if (!job.output().empty()) jobs::write_document(job.output(), result, {.binary_uff = job.flag("binary")});
  return outcome_of(result);
}

JobOutcome run_modes(const VerbJob& job, Progress& progress) {
  modal::FitOptions options;
  std::vector<std::string> notes;
  if (job.has("config")) options = modal::read_fit_options(job.file("config"), notes);
  options.seed = job.seed();
  options.method = job.word("method", modal::fit_method_names).value_or(options.method);
  if (const std::vector<double> band = job.numbers("band_hz"); !band.empty()) {
    options.band_low_hz = band[0];
    options.band_high_hz = band[1];
  }
  options.modes = job.get("modes", options.modes);
  return finished(job, jobs::run_modes({.frfs = job.inputs(),
                                        .as = job.texts("as"),
                                        .options = options,
                                        .accept_fit = job.flag("accept_fit"),
                                        .notes = notes},
                                       progress));
}

JobOutcome run_posture_modes(const VerbJob& job, Progress& progress) {
  const auto axes = job.word("axes", cell::posture_axes_names).value_or(cell::PostureAxes::base);
  return finished(job, cell::posture_modes(job.input(), job.numbers("joints_deg", units::deg), axes, progress));
}

JobOutcome run_couple(const VerbJob& job, Progress& progress) {
  const jobs::TipPrediction result = jobs::predict_tip(job.input(), {}, {.rotations = job.flag("rotations")}, progress);
  if (job.has("holder_out")) {
    jobs::require_holder(result, "options.holder_out");
    modal::write_frfs(job.file("holder_out"), result.holder);
  }
  return finished(job, result);
}

JobOutcome run_tools(const VerbJob& job, Progress& progress) {
  const jobs::ToolsResult result = jobs::run_tools(
      {.assembly = job.input(), .tools = job.file("tools"), .lobes = job.file("lobes"), .seed = job.seed()}, progress);
  if (job.has("frfs")) jobs::write_tips(job.file("frfs"), result.tools);
  return finished(job, result);
}

JobOutcome run_joint(const VerbJob& job, Progress& progress) {
  const jobs::JointJob wanted = {
      .assembly = job.input(),
      .measured = job.files("measured"),
      .as = job.texts("as"),
      .method = job.word("method", coupling::joint_method_names).value_or(coupling::JointMethod::hybrid),
      .mutation = job.word("mutation", coupling::mutation_names),
      .axis = job.get("axis", std::string("x")) == "y" ? modal::Axis::y : modal::Axis::x,
      .seed = job.seed()};
  return finished(job, jobs::run_joint(wanted, progress));
}

JobOutcome run_lobes(const VerbJob& job, Progress& progress) {
  jobs::LobesJob wanted = {.lobes = job.input(), .compare = job.flag("compare"), .seed = job.seed()};
  if (job.has("at")) {
    for (const io::Json& pair : job.option("at")) wanted.points.push_back(VerbJob::point(pair));
  }
  return finished(job, jobs::run_lobes(wanted, progress));
}

JobOutcome run_simulate(const VerbJob& job, Progress& progress) {
  jobs::SimulateJob wanted = {.lobes = job.input(), .point = VerbJob::point(job.option("at"))};
  wanted.options.seconds = job.get("seconds", wanted.options.seconds);
  wanted.options.sample_rate_hz = job.get("sample_rate_hz", wanted.options.sample_rate_hz);
  wanted.options.loss_of_contact = !job.flag("linear");
  wanted.options.seed = job.seed();
  return finished(job, jobs::run_simulate(wanted, progress));
}

JobOutcome run_explain(const VerbJob& job, Progress&) {
  jobs::ExplainJob wanted = {.peaks = {job.numbers("peaks_hz"), job.get("rpm", 0.0) * units::rpm, job.get("teeth", 0)},
                             .options = {job.get("tolerance_hz", 1.0), job.get("speed_tolerance_percent", 0.2) / 100.0},
                             .modes = job.input(),
                             .lobes = job.file("lobes")};
  if (job.has("lobes") != job.has("at")) {
    throw InvalidInput(job.has("at") ? "options.lobes" : "options.at", "lobes and at go together",
                       "The cut says whether its chatter needs the delay");
  }
  if (job.has("at")) wanted.point = VerbJob::point(job.option("at"));
  return finished(job, jobs::run_explain(wanted));
}

JobOutcome run_forces(const VerbJob& job, Progress& progress) {
  return finished(job, jobs::run_forces(job.input(), job.file("program"), job.file("cell"), progress));
}

JobOutcome run_coefficients(const VerbJob& job, Progress&) {
  return finished(job, jobs::run_coefficients({.slots = job.input(), .teeth = job.get("teeth", 0)}));
}

JobOutcome run_stiffness(const VerbJob& job, Progress&) {
  jobs::StiffnessJob wanted = {.loads = job.input(), .cell = job.file("cell"), .output = job.output()};
  if (const std::vector<double> point = job.numbers("point_mm", units::mm); !point.empty()) {
    wanted.point_m = Eigen::Vector3d(point[0], point[1], point[2]);
  }
  return finished(job, jobs::run_stiffness(wanted));
}

JobOutcome run_cell_check(const VerbJob& job, Progress& progress) {
  cell::CellFile cell = cell::read_cell(job.input(), cell::Robots::any);
  const double unit = cell.hybrid ? units::mm : units::deg;  // all of its joints slide
  const cell::CellCheckJob wanted = {
      .cell = job.input(), .joints = job.numbers("joints", unit), .program = job.file("program")};
  return finished(job, cell::run_cell_check(wanted, std::move(cell), progress));
}

JobOutcome run_smooth(const VerbJob& job, Progress& progress) {
  const jobs::SmoothJob wanted = {.program = job.input(),
                                  .cell = job.file("cell"),
                                  .method = job.word("method", path::method_names),
                                  .compare = job.flag("compare"),
                                  .options = {.output = job.output(),
                                              .keep_violations = job.flag("keep_violations"),
                                              .program_period_s = job.get("program_period_ms", 0.0) * units::ms}};
  return outcome_of(jobs::run_smooth(wanted, progress));  // which writes the trajectory itself
}

}  // namespace robomill::serve
