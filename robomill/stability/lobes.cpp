#include "robomill/stability/lobes.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/chart/cost.hpp"
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

/// The limits at the points' speeds, and before them those of the grid where nothing else is wanted.
void add_limits(Scheme& scheme, const LobesOptions& options, LobesResult& result, Count& count, Progress& progress) {
  std::vector<double> speeds;
  if (options.output == Output::limits) speeds = even(options.spindle_speed_rad_per_s, options.grid[0]);
  const std::size_t of_grid = speeds.size();
  for (const OperatingPoint& point : options.points) speeds.push_back(point.spindle_speed_rad_per_s);
  if (speeds.empty()) return;
  const Axes columns = column_axes(options, speeds);
  scheme.expect(columns.axial_depth_m, columns.fine > 1);
  std::vector<Limit> limits = column_limits(scheme, columns, options.tolerance, count, progress);
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Limit& limit = limits[of_grid + i];
    const bool found = limit.status == Limit::Status::found;
    result.points[i].limit_depth_m = found ? limit.axial_depth_m : std::numeric_limits<double>::infinity();
  }
  limits.resize(of_grid);
  if (options.output == Output::limits) result.limit = std::move(limits);
}

/// Map, boundary and the grid's limits.
long long add_chart(Scheme& scheme, const LobesOptions& options, LobesResult& result, Count& count,
                    Progress& progress) {
  const Axes axes = even_axes(options);
  scheme.expect(axes.axial_depth_m);
  GridRadii grid;
  if (options.output == Output::boundary) {
    grid = find_boundary_nodes(scheme, axes, count, progress);
  } else {
    // The discretizations estimate the error that their intervals leave; a map of it would triple their cost.
    const bool collocated = options.method == Method::collocation;
    grid = evaluate_grid(scheme, axes, collocated ? std::optional(options.tolerance) : std::nullopt, count, progress);
    result.spectral_radius = grid.radius;
  }
  if (options.output != Output::map) {
    result.boundary = string_boundary(scheme, axes, grid, options.tolerance, count, progress);
  }
  result.limit = grid_limits(scheme, axes, grid, result.boundary, options.tolerance, count, progress);
  return grid.uncertain;
}

/// Of the chart, and of its points with their limits: the threads that it may use.
int require_affordable_chart(const LobesProblem& problem, const LobesOptions& options) {
  constexpr double usual_nodes = 40'000.0;
  const double depths = options.grid[1], nodes = options.grid[0] * depths;
  const double larger = std::max(options.grid[0], options.grid[1]);
  const bool map = options.output == Output::map || options.output == Output::both;
  // A map in memory, and as numbers of a document. Of a boundary each node is known or not.
  Looks looks = {.a_speed = looks_a_limit,
                 .bytes = map ? 60.0 * nodes : 0.0,
                 .counted = {.field = "grid", .value = larger, .times_usual = nodes / usual_nodes}};
  if (map) looks.a_speed = looks_a_node * depths;
  if (options.output == Output::boundary && !in_frequency_domain(options.method)) {
    looks.a_speed = 10.0 + 0.5 * depths + 80.0 / options.grid[0];
    looks.bytes = 9.0 * nodes;
  }
  Cost cost = cost_of_looks(problem, options, even(options.spindle_speed_rad_per_s, options.grid[0]), looks);
  add_cost_of_points(problem, options, cost);
  return require_affordable(cost);
}

}  // namespace

LobesResult compute_lobes(const LobesProblem& problem, const LobesOptions& options, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  problem.validate();
  options.validate();
  require_known(problem, options.method);
  const ThreadLimit threads(require_affordable_chart(problem, options));
  if (in_frequency_domain(options.method)) {
    LobesResult result = frequency_lobes(problem, options, progress);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
  }
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, options);
  const Axes axes = even_axes(options);
  const bool alone = options.output == Output::limits;
  LobesResult result;
  result.spindle_speed_rad_per_s = to_eigen(axes.spindle_speed_rad_per_s);
  result.axial_depth_m = to_eigen(axes.axial_depth_m);
  result.method = options.method;
  result.period = scheme->period();
  Count count;
  const long long uncertain = alone ? 0 : add_chart(*scheme, options, result, count, progress);
  const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
  for (const OperatingPoint& point : options.points) {
    progress.check();
    result.points.push_back(point_result(*evaluator, point));
    if (!problem.in_three_directions() || alone) continue;
    result.points.back().gain_margin = gain_of(search_gain(*evaluator, point, options.tolerance, progress));
  }
  add_limits(*scheme, options, result, count, progress);
  count.add(*evaluator);
  result.evaluations = count.evaluations;
  result.unsettled = count.unsettled;
  if (options.method == Method::collocation) {
    const bool estimated = !alone || options.limit_step_m == 0.0;
    result.uncertain = uncertain + count_uncertain(result.boundary, options.tolerance) +
                       (estimated ? count_uncertain(result.limit, options.tolerance) : 0) +
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
  require_affordable(cost_of_looks(problem, checked, std::array{point.spindle_speed_rad_per_s}, {.a_speed = 3.0}));
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
  for (const double speed : spindle_speeds_rad_per_s) cutting::require_spindle_speed("spindle_speed_rad_per_s", speed);
  constexpr double usual_speeds = 200.0;
  const auto speeds = static_cast<double>(spindle_speeds_rad_per_s.size());
  const ThreadLimit threads(require_affordable(cost_of_looks(problem, options, spindle_speeds_rad_per_s,
                                                             {.a_speed = looks_a_limit,
                                                              .counted = {.field = "spindle_speeds_rad_per_s",
                                                                          .value = speeds,
                                                                          .unit = "speeds",
                                                                          .times_usual = speeds / usual_speeds}})));
  if (in_frequency_domain(options.method)) {
    return frequency_limits(problem, options, spindle_speeds_rad_per_s, progress);
  }
  const std::unique_ptr<Scheme> scheme = make_scheme(problem, options);
  const Axes axes = column_axes(options, spindle_speeds_rad_per_s);
  scheme->expect(axes.axial_depth_m, axes.fine > 1);
  Count count;
  return column_limits(*scheme, axes, options.tolerance, count, progress);
}

}  // namespace robomill::stability
