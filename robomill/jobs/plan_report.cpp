#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "robomill/base/units.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/summary.hpp"
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

void add_fit(report::Report& report, const PlanResult& result) {
  report.model = result.model;
  LimitShare share = limit_share(result);
  report.limit_share = std::move(share.tool);
  if (!result.cut.problem.workpiece_dynamics.modes.empty()) {
    report.workpiece_model = result.cut.problem.workpiece_dynamics;
    report.workpiece_limit_share = std::move(share.workpiece);
  }
  if (!result.fit) return;
  const modal::FitResult& fit = *result.fit;
  report::FitSummary summary;
  summary.method = "hybrid";
  summary.relative_error = fit.relative_error;
  summary.mean_relative_error = fit.mean_relative_error;
  summary.band_from_hz = fit.band_low_hz;
  summary.band_to_hz = fit.band_high_hz;
  summary.converged = fit.status == modal::FitResult::Status::converged;
  summary.convergence = Eigen::Map<const Eigen::VectorXd>(fit.best.data(), static_cast<Eigen::Index>(fit.best.size()));
  for (const modal::StabilisationPoint& point : fit.stabilisation) {
    summary.stabilisation.push_back({.order = point.order,
                                     .frequency_hz = point.frequency_hz,
                                     .stable = point.frequency_stable && point.damping_stable && point.vector_stable});
  }
  report.fit = std::move(summary);
}

report::BoundaryKind to_report(stability::BifurcationType kind) {
  switch (kind) {
    case stability::BifurcationType::flip:
      return report::BoundaryKind::flip;
    case stability::BifurcationType::fold:
      return report::BoundaryKind::fold;
    case stability::BifurcationType::hopf:
      break;
  }
  return report::BoundaryKind::hopf;
}

void add_lobes(report::Report& report, const PlanResult& result) {
  const stability::LobesResult& lobes = result.lobes;
  report::Lobes all;
  all.label = "all modes";
  all.spindle_speed_rad_per_s = lobes.spindle_speed_rad_per_s;
  all.searched_depth_m = result.cut.options.axial_depth_m[1];
  all.limit_depth_m.resize(static_cast<Eigen::Index>(lobes.limit.size()));
  for (std::size_t i = 0; i < lobes.limit.size(); ++i) {
    const bool found = lobes.limit[i].status == stability::Limit::Status::found;
    all.limit_depth_m(static_cast<Eigen::Index>(i)) = found ? lobes.limit[i].axial_depth_m : report::missing;
  }
  for (const stability::BoundaryPoint& point : lobes.boundary) {
    all.boundary.push_back({.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s,
                            .axial_depth_m = point.axial_depth_m,
                            .chatter_frequency_hz = point.chatter_frequency_hz,
                            .kind = to_report(point.kind),
                            .mode = point.mode});
  }
  if (result.uncertain.samples > 0) {
    const auto shown = [](const Eigen::VectorXd& depth_m) -> Eigen::VectorXd {
      return depth_m.unaryExpr([](double depth) { return std::isfinite(depth) ? depth : report::missing; });
    };
    all.band.label = fmt::format("5 to 95 % of {} samples", result.uncertain.samples);
    all.band.spindle_speed_rad_per_s = result.uncertain.spindle_speed_rad_per_s;
    all.band.low_m = shown(result.uncertain.limit_5_percent_m);
    all.band.high_m = shown(result.uncertain.limit_95_percent_m);
  }
  if (lobes.spectral_radius.size() > 0) {
    all.map_speed_rad_per_s = lobes.spindle_speed_rad_per_s;
    all.map_depth_m = lobes.axial_depth_m;
    all.spectral_radius = lobes.spectral_radius;
  }
  report.lobes.push_back(std::move(all));
  report.lobes.insert(report.lobes.end(), result.pairs.begin(), result.pairs.end());
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
  add_fit(report, result);
  if (result.has_lobes()) add_lobes(report, result);
  if (result.forces) report.forces = with_limits(forces_report(*result.forces), result);
  if (result.path) report.smooth = smooth_report(*result.path);
  report.files = files;
  return report;
}

}  // namespace robomill::jobs
