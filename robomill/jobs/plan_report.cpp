#include <fmt/format.h>

#include "robomill/base/units.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/path/files/motion_json.hpp"

namespace robomill::jobs {
namespace {

DepthCurve spindle_curve(const PlanResult& result, const std::string& label, bool torque) {
  const auto torque_of = decision::mean_torque_of(result.cut.problem.milling);
  const double deepest_m = 10.0 * result.cut.options.axial_depth_m[1];  // beyond any chart
  DepthCurve curve;
  curve.label = label;
  const auto n = static_cast<Eigen::Index>(result.job.recommend.spindle.size());
  curve.spindle_speed_rad_per_s.resize(n);
  curve.axial_depth_m.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const decision::SpindleCapacity& p = result.job.recommend.spindle[static_cast<std::size_t>(i)];
    curve.spindle_speed_rad_per_s(i) = p.spindle_speed_rad_per_s;
    const double able_n_m = torque ? p.torque_n_m : p.power_w / p.spindle_speed_rad_per_s;
    curve.axial_depth_m(i) = decision::depth_of_torque_m(torque_of, able_n_m, deepest_m);
  }
  return curve;
}

}  // namespace

std::string limited_by_text(const decision::Operation& operation) {
  switch (operation.limited_by) {
    case decision::LimitedBy::chatter:
      return fmt::format("chatter of {} at {:.1f} Hz", to_string(operation.mode), operation.chatter_frequency_hz);
    case decision::LimitedBy::depth_range:
      return fmt::format("the depth range of the lobes: no chatter found up to its end, {:.3g} mm",
                         operation.limit_depth_m / units::mm);
    case decision::LimitedBy::cutter:
      return "the cutter's depth";
    case decision::LimitedBy::spindle_torque:
      return "the spindle's torque";
    case decision::LimitedBy::spindle_power:
      return "the spindle's power";
    case decision::LimitedBy::surface_error:
      return "the permitted surface error";
    case decision::LimitedBy::deflection:
      return "the permitted deflection";
    case decision::LimitedBy::forced_vibration:
      return fmt::format(
          "forced vibration: within the speed window its amplitude, {:.3g} µm at this speed, may be the feed per tooth "
          "at most, {:.3g} µm",
          operation.vibration.amplitude_m / units::um, operation.feed_per_tooth_m / units::um);
  }
  return {};
}

std::vector<DepthCurve> other_limits(const PlanResult& result) {
  std::vector<DepthCurve> curves;
  if (!result.recommends()) return curves;
  if (result.job.recommend.spindle.size() > 1) {
    curves.push_back(spindle_curve(result, "spindle torque", true));
    curves.push_back(spindle_curve(result, "spindle power", false));
  }
  if (result.job.recommend.max_axial_depth_m > 0.0) {
    const std::array<double, 2>& speeds = result.cut.options.spindle_speed_rad_per_s;
    curves.push_back({.label = "cutter's depth",
                      .spindle_speed_rad_per_s = Eigen::Vector2d(speeds[0], speeds[1]),
                      .axial_depth_m = Eigen::Vector2d::Constant(result.job.recommend.max_axial_depth_m)});
  }
  return curves;
}

LimitShare limit_share(const PlanResult& result) {
  const auto zeros = [](const modal::ModalModel& model) {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.modes.size())).eval();
  };
  LimitShare share = {zeros(result.model), zeros(result.cut.problem.workpiece_dynamics)};
  for (const stability::Limit& limit : result.lobes.limit) {
    if (limit.status != stability::Limit::Status::found || !limit.mode.known()) continue;
    Eigen::VectorXd& owner = limit.mode.of == modal::ModeOwner::tool ? share.tool : share.workpiece;
    owner(limit.mode.number - 1) += 1.0;
  }
  const double total = share.tool.sum() + share.workpiece.sum();
  if (total == 0.0) return {};
  share.tool /= total;
  share.workpiece /= total;
  return share;
}

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
  if (!result.recordings.empty()) report.recordings = io::dump(recordings_json(result));
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
