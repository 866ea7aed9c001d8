#include "robomill/stability/lobes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/chart/gain_search.hpp"
#include "robomill/stability/frequency_domain/frequency_lobes.hpp"
#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability {
namespace {

using namespace detail;

/// Points of the boundary and limits have the radius 1.
template <class Points>
long long count_uncertain(const Points& points, double tolerance) {
  return std::ranges::count_if(points, [&](const auto& point) {
    double radius = 1.0;
    if constexpr (requires { point.spectral_radius; }) radius = std::max(radius, point.spectral_radius);
    return !(point.error_estimate <= tolerance * radius);
  });
}

}  // namespace

LobesResult compute_lobes(const LobesProblem& problem, const LobesOptions& options, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  problem.validate();
  options.validate();
  require_known(problem, options.method);
  if (in_frequency_domain(options.method)) {
    LobesResult result = frequency_lobes(problem, options, progress);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
  }
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, options);
  const Axes axes = even_axes(options);
  LobesResult result;
  result.spindle_speed_rad_per_s = to_eigen(axes.spindle_speed_rad_per_s);
  result.axial_depth_m = to_eigen(axes.axial_depth_m);
  result.method = options.method;
  result.period = scheme->period();
  scheme->expect(axes.axial_depth_m);
  const bool collocated = options.method == Method::collocation;
  Count count;
  GridRadii grid;
  if (options.output == Output::boundary) {
    grid = find_boundary_nodes(*scheme, axes, count, progress);
  } else {
    // The discretizations estimate the error that their intervals leave; a map of it would triple their cost.
    grid = evaluate_grid(*scheme, axes, collocated ? std::optional(options.tolerance) : std::nullopt, count, progress);
    result.spectral_radius = grid.radius;
  }
  if (options.output != Output::map) {
    result.boundary = string_boundary(*scheme, axes, grid, options.tolerance, count, progress);
  }
  result.limit = grid_limits(*scheme, axes, grid, result.boundary, options.tolerance, count, progress);
  const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
  for (const OperatingPoint& point : options.points) {
    progress.check();
    result.points.push_back(point_result(*evaluator, point));
    if (!problem.in_three_directions()) continue;
    result.points.back().gain_margin = gain_of(search_gain(*evaluator, point, options.tolerance, progress));
  }
  count.add(*evaluator);
  result.evaluations = count.evaluations;
  result.unsettled = count.unsettled;
  if (collocated) {
    result.uncertain = grid.uncertain + count_uncertain(result.boundary, options.tolerance) +
                       count_uncertain(result.limit, options.tolerance) +
                       count_uncertain(result.points, options.tolerance);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

PointResult evaluate_point(const LobesProblem& problem, const LobesOptions& options, const OperatingPoint& point) {
  problem.validate();
  require_known(problem, options.method);
  LobesOptions checked = options;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.axial_depth_m = {0.0, 0.1};
  checked.points = {point};
  checked.validate();
  if (in_frequency_domain(options.method)) return frequency_point(problem, options, point);
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, options);
  return point_result(*scheme->evaluator(), point);
}

std::vector<Limit> limit_depths(const LobesProblem& problem, const LobesOptions& options,
                                const std::vector<double>& spindle_speeds_rad_per_s, Progress& progress) {
  problem.validate();
  require_known(problem, options.method);
  LobesOptions checked = options;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.validate();
  for (const double speed : spindle_speeds_rad_per_s) require_positive("spindle_speed_rad_per_s", speed, "rad/s");
  if (in_frequency_domain(options.method)) {
    return frequency_limits(problem, options, spindle_speeds_rad_per_s, progress);
  }
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, options);
  const Axes axes = {spindle_speeds_rad_per_s, even(options.axial_depth_m, options.grid[1])};
  scheme->expect(axes.axial_depth_m);
  Count count;
  return column_limits(*scheme, axes, options.tolerance, count, progress);
}

}  // namespace robomill::stability
