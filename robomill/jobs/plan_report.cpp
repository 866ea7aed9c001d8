#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "robomill/base/units.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/version.hpp"

namespace robomill::jobs {
namespace {

report::Grade to_report(modal::Grade grade) {
  switch (grade) {
    case modal::Grade::good:
      return report::Grade::good;
    case modal::Grade::usable:
      return report::Grade::fair;
    case modal::Grade::poor:
      break;
  }
  return report::Grade::poor;
}

void add_frfs(report::Report& report, const PlanResult& result) {
  if (!result.frfs) return;
  const modal::FrfSet& set = *result.frfs;
  report.frf_frequency_hz = set.frequency_hz;
  std::optional<modal::FrfSet> fitted;
  // A mass residual has no value at 0 Hz: the fitted curve starts behind it.
  const Eigen::Index first = set.frequency_hz(0) == 0.0 ? 1 : 0;
  if (result.fit) fitted = modal::synthesize(result.fit->model, set.frequency_hz.tail(set.frequency_hz.size() - first));
  for (std::size_t i = 0; i < set.frfs.size(); ++i) {
    const modal::Frf& frf = set.frfs[i];
    report::FrfPlot plot{.name = frf.name, .measured = frf.receptance, .coherence = frf.coherence};
    if (fitted) {
      if (const modal::Frf* model = fitted->find(frf.name)) {
        plot.fitted.setConstant(set.frequency_hz.size(), report::missing);
        plot.fitted.tail(model->receptance.size()) = model->receptance;
      }
    }
    if (result.fit) {
      for (const modal::FrfFitError& error : result.fit->by_frf) {
        if (error.name == frf.name) plot.relative_error = error.error.relative;
      }
    }
    if (result.hits) {
      const modal::FrfGrade& grade = result.hits->grades[i];
      plot.grade = to_report(grade.grade);
      plot.findings = grade.faults;
      plot.remedies = grade.remedies;
      plot.trusted_from_hz = grade.lowest_trustworthy_frequency_hz;
      plot.trusted_to_hz = grade.excited_high_hz;
    }
    report.frfs.push_back(std::move(plot));
  }
}

void add_hits(report::Report& report, const PlanResult& result) {
  if (!result.hits) return;
  for (std::size_t i = 0; i < result.hits->hits.size(); ++i) {
    const modal::HitVerdict& hit = result.hits->hits[i];
    report.hits.push_back({.file = std::filesystem::path(hit.file).filename().string(),
                           .direction = result.hit_directions.at(i),
                           .accepted = hit.accepted,
                           .reasons = hit.reasons});
  }
}

DepthCurve spindle_curve(const PlanResult& result, const std::string& label, bool torque) {
  const double per_depth =
      cutting::mean_load(result.cut.problem.milling, 1.0, result.cut.problem.milling.feed_per_tooth_m, 1.0).torque_n_m;
  DepthCurve curve;
  curve.label = label;
  const auto n = static_cast<Eigen::Index>(result.job.spindle_curve.size());
  curve.spindle_speed_rad_per_s.resize(n);
  curve.axial_depth_m.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const SpindlePoint& p = result.job.spindle_curve[static_cast<std::size_t>(i)];
    curve.spindle_speed_rad_per_s(i) = p.spindle_speed_rad_per_s;
    curve.axial_depth_m(i) = (torque ? p.torque_n_m : p.power_w / p.spindle_speed_rad_per_s) / per_depth;
  }
  return curve;
}

/// What the spindle has, where the whole program runs at one speed of its curve.
report::Forces with_limits(report::Forces forces, const PlanResult& result) {
  if (!forces.path || result.job.spindle_curve.empty()) return forces;
  const std::vector<SpindleLoad> loads = spindle_loads(*result.forces);
  if (loads.empty()) return forces;
  const double speed = loads.front().spindle_speed_rad_per_s;
  if (std::ranges::any_of(loads, [&](const SpindleLoad& l) { return l.spindle_speed_rad_per_s != speed; })) {
    return forces;
  }
  std::vector<decision::SpindleCapacity> curve;
  curve.reserve(result.job.spindle_curve.size());
  for (const SpindlePoint& p : result.job.spindle_curve) {
    curve.push_back({p.spindle_speed_rad_per_s, p.torque_n_m, p.power_w});
  }
  const decision::SpindleCapacity able = decision::capacity_at(curve, speed);
  if (able.torque_n_m > 0.0) forces.path->torque_limit_n_m = able.torque_n_m;
  if (able.power_w > 0.0) forces.path->power_limit_w = able.power_w;
  return forces;
}

}  // namespace

std::string limited_by_text(const decision::Operation& operation) {
  switch (operation.limited_by) {
    case decision::LimitedBy::chatter:
      return fmt::format("chatter of {} at {:.1f} Hz", to_string(operation.mode), operation.chatter_frequency_hz);
    case decision::LimitedBy::depth_range:
      return "the depth range of the lobes: no chatter found up to its end";
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
  }
  return {};
}

std::vector<DepthCurve> other_limits(const PlanResult& result) {
  std::vector<DepthCurve> curves;
  if (result.job.spindle_curve.size() > 1) {
    curves.push_back(spindle_curve(result, "spindle torque", true));
    curves.push_back(spindle_curve(result, "spindle power", false));
  }
  if (result.job.max_axial_depth_m > 0.0) {
    const std::array<double, 2>& speeds = result.cut.options.spindle_speed_rad_per_s;
    curves.push_back({.label = "cutter's depth",
                      .spindle_speed_rad_per_s = Eigen::Vector2d(speeds[0], speeds[1]),
                      .axial_depth_m = Eigen::Vector2d::Constant(result.job.max_axial_depth_m)});
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

report::Report make_report(const PlanResult& result, const std::vector<report::StageFile>& files) {
  report::Report report;
  if (!result.job.title.empty()) report.title = result.job.title;
  report.created = fmt::format("{:%Y-%m-%d %H:%M} UTC, robomill " ROBOMILL_VERSION, fmt::gmtime(std::time(nullptr)));
  report.summary = summary(result);
  add_frfs(report, result);
  if (result.prediction) add_prediction(report, *result.prediction);
  add_hits(report, result);
  report.plan = io::dump(decision_json(result));
  report.modes = modes_json(result);
  const modal::ModalModel& workpiece = result.cut.problem.workpiece_dynamics;
  if (!workpiece.modes.empty()) report.workpiece_modes = modal::modes_json(workpiece);
  if (result.has_lobes()) report.lobes = lobes_json(result);
  if (!result.recordings.empty()) report.recordings = io::dump(recordings_json(result));
  if (result.forces) report.forces = with_limits(forces_report(*result.forces), result);
  if (result.path) report.smooth = smooth_report(*result.path);
  report.files = files;
  return report;
}

}  // namespace robomill::jobs
