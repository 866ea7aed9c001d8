#include "robomill/stability/sweep.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/chart/cost.hpp"
#include "robomill/stability/chart/gain_search.hpp"
#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability {
namespace {

using namespace detail;

/// Of one grid speed, from the stability of its lowest value and the boundary's crossings of its column.
std::vector<StableInterval> stable_intervals(const Axes& axes, std::size_t speed, bool unstable_at_start,
                                             const std::vector<BoundaryPoint>& boundary) {
  std::vector<double> crossings;
  for (const BoundaryPoint& point : boundary) {
    if (point.spindle_speed_rad_per_s == axes.spindle_speed_rad_per_s[speed]) crossings.push_back(point.axial_depth_m);
  }
  std::ranges::sort(crossings);
  std::vector<StableInterval> intervals;
  bool stable = !unstable_at_start;
  double from = axes.axial_depth_m.front();
  for (const double crossing : crossings) {
    if (stable) intervals.push_back({from, crossing});
    from = crossing;
    stable = !stable;
  }
  if (stable) intervals.push_back({from, axes.axial_depth_m.back()});
  return intervals;
}

/// Every node to the tolerance, and each point with its gain margin: the threads that may do it.
int require_affordable_sweep(const LobesProblem& problem, const SweepOptions& options, const Axes& axes) {
  constexpr double usual_nodes = 2400.0;
  const double depths = options.grid[1], nodes = options.grid[0] * depths;
  const double larger = std::max(options.grid[0], options.grid[1]);
  const LobesOptions as_chart = {.tolerance = options.tolerance, .points = options.points};
  Cost cost = cost_of_looks(problem, as_chart, axes.spindle_speed_rad_per_s,
                            {.a_speed = looks_a_node * depths,
                             .bytes = 60.0 * nodes,
                             .counted = {.field = "grid", .value = larger, .times_usual = nodes / usual_nodes}});
  add_cost_of_points(problem, as_chart, cost);
  return require_affordable(cost);
}

}  // namespace

void SweepOptions::validate() const {
  const bool angle = is_angle(parameter);
  const char* const unit = angle ? "rad" : "m";
  for (const double end : range) require_finite("range", end, unit);
  if (!(range[1] > range[0])) {
    throw InvalidInput("range", range[1], unit, "must end above its start", "Give the lower end first");
  }
  if (!angle && !(range[0] >= 0.0)) throw InvalidInput("range", range[0], unit, "must start at 0 or above");
  if (!(spindle_speed_rad_per_s[0] > 0.0)) {
    throw InvalidInput("spindle_speed_rad_per_s", spindle_speed_rad_per_s[0], "rad/s", "must start above 0");
  }
  if (!(spindle_speed_rad_per_s[1] > spindle_speed_rad_per_s[0])) {
    throw InvalidInput("spindle_speed_rad_per_s", spindle_speed_rad_per_s[1], "rad/s", "must end above its start",
                       "Give the lower end first");
  }
  for (const double end : spindle_speed_rad_per_s) cutting::require_spindle_speed("spindle_speed_rad_per_s", end);
  for (const int count : grid) {
    if (count < 2 || count > 2000) throw InvalidInput("grid", count, "", "must lie between 2 and 2000");
  }
  for (const OperatingPoint& point : points) {
    cutting::require_spindle_speed("points.spindle_speed_rad_per_s", point.spindle_speed_rad_per_s);
    require_finite("points.value", point.axial_depth_m, unit);
    if (!angle) require_non_negative("points.value", point.axial_depth_m, unit);
    require_positive("points.gain", point.gain, "");
  }
  if (!(tolerance >= 1e-10 && tolerance <= 0.1)) {
    throw InvalidInput("tolerance", tolerance, "", "must lie between 1e-10 and 0.1");
  }
}

SweepResult compute_sweep(const LobesProblem& problem, const SweepOptions& options, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  problem.validate();
  options.validate();
  if (!problem.spatial) throw InvalidInput("spatial", "must be there: a sweep is one of a cut in three directions");
  if (problem.spatial->engagement && options.parameter != SweptParameter::axial_depth) {
    throw InvalidInput("parameter", "must be the axial depth where the engagement is given: the rest of it is fixed");
  }
  if (options.parameter == SweptParameter::radial_depth && !problem.spatial->engagement &&
      problem.spatial->cut.direction == cutting::MillingDirection::slot) {
    throw InvalidInput("parameter", "must not be the step-over of a slot, which has no neighbour");
  }
  const Axes axes = {even(options.spindle_speed_rad_per_s, options.grid[0]), even(options.range, options.grid[1])};
  const ThreadLimit threads(require_affordable_sweep(problem, options, axes));
  const std::unique_ptr<Scheme> scheme = sweep_collocation(problem, options.parameter, options.tolerance);
  scheme->expect(axes.axial_depth_m);
  SweepResult result;
  result.parameter = options.parameter;
  result.spindle_speed_rad_per_s = to_eigen(axes.spindle_speed_rad_per_s);
  result.value = to_eigen(axes.axial_depth_m);
  result.period = scheme->period();
  Count count;
  const GridRadii grid = evaluate_grid(*scheme, axes, options.tolerance, count, progress);
  result.spectral_radius = grid.radius;
  result.boundary = string_boundary(*scheme, axes, grid, options.tolerance, count, progress);
  for (std::size_t s = 0; s < axes.spindle_speed_rad_per_s.size(); ++s) {
    const bool unstable = grid.unstable(0, static_cast<Eigen::Index>(s));
    result.stable.push_back(stable_intervals(axes, s, unstable, result.boundary));
  }
  const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
  for (const OperatingPoint& point : options.points) {
    progress.check();
    result.points.push_back(point_result(*evaluator, point));
    result.points.back().gain_margin = gain_of(search_gain(*evaluator, point, options.tolerance, progress));
  }
  count.add(*evaluator);
  result.evaluations = count.evaluations;
  result.unsettled = count.unsettled;
  result.uncertain = grid.uncertain + std::ranges::count_if(result.boundary, [&](const BoundaryPoint& point) {
                       return !(point.error_estimate <= options.tolerance);
                     });
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

GainMargin gain_margin(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  problem.validate();
  LobesOptions checked;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.axial_depth_m = {0.0, 0.1};
  checked.tolerance = tolerance;
  checked.points = {point};
  checked.validate();
  require_affordable(
      cost_of_looks(problem, checked, std::array{point.spindle_speed_rad_per_s}, {.a_speed = looks_a_limit}));
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, checked);
  const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
  return search_gain(*evaluator, point, tolerance, Progress::none());
}

}  // namespace robomill::stability
