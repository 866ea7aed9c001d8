#include "robomill/stability/frequency_domain/frequency_lobes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/frequency_domain/frequency_domain.hpp"

namespace robomill::stability::detail {
namespace {

/// Tool and workpiece, each from its modes or as measured.
FrequencyResponse response_of(const LobesProblem& problem) {
  FrequencyResponse response;
  if (problem.measured.frfs.empty()) {
    response = FrequencyResponse::of_modes(problem);
  } else {
    response = FrequencyResponse::of_frfs(problem.measured, problem.feed_direction_rad);
    if (!problem.workpiece_dynamics.modes.empty()) {
      response += FrequencyResponse::of_modes(
          modal::tip_modes(problem.workpiece_dynamics, {}, problem.feed_direction_rad, modal::ModeOwner::workpiece));
    }
  }
  if (!problem.workpiece_measured.frfs.empty()) {
    response += FrequencyResponse::of_frfs(problem.workpiece_measured, problem.feed_direction_rad);
  }
  return response;
}

std::vector<FrequencyLimit> solve(const LobesProblem& problem, const LobesOptions& options,
                                  const std::vector<double>& speeds, double largest_depth_m, bool all_crossings,
                                  Progress& progress) {
  const FrequencyResponse response = response_of(problem);
  FrequencyOptions how;
  how.largest_depth_m = largest_depth_m;
  how.tolerance = options.tolerance;
  how.all_crossings = all_crossings;
  auto limits = options.method == Method::zeroth_order
                    ? zeroth_order_limits(problem.milling, response, speeds, how, progress)
                    : multi_frequency_limits(problem.milling, response, speeds, how, progress);
  if (response.measured()) require_coverage(response, limits);
  return limits;
}

/// As a share of the limit.
double error_share(const FrequencyLimit& limit) {
  if (limit.status == FrequencyLimit::Status::stable_in_range) return 0.0;
  return limit.axial_depth_m > 0.0 ? limit.error_estimate_m / limit.axial_depth_m : 0.0;
}

Limit to_limit(const FrequencyLimit& found) {
  Limit limit;
  limit.spindle_speed_rad_per_s = found.spindle_speed_rad_per_s;
  if (found.status == FrequencyLimit::Status::stable_in_range) return limit;
  limit.status = Limit::Status::found;
  limit.axial_depth_m = found.axial_depth_m;
  limit.chatter_frequency_hz = found.chatter_frequency_hz;
  limit.kind = found.kind;
  limit.mode = found.mode;
  limit.error_estimate = error_share(found);
  return limit;
}

PointResult to_point(const FrequencyLimit& found, const OperatingPoint& point) {
  PointResult result;
  result.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  result.axial_depth_m = point.axial_depth_m;
  result.spectral_radius = std::numeric_limits<double>::quiet_NaN();
  result.multiplier = result.spectral_radius;
  result.error_estimate = result.spectral_radius;
  const bool limited = found.status != FrequencyLimit::Status::stable_in_range;
  result.stable = !limited || point.axial_depth_m < found.axial_depth_m;
  if (!result.stable) {
    result.chatter_frequency_hz = found.chatter_frequency_hz;
    result.kind = found.kind;
    result.mode = found.mode;
  }
  return result;
}

void require_depth(const LobesOptions& options) {
  if (options.output != Output::boundary && options.output != Output::limits) {
    throw InvalidInput("output", std::string(to_string(options.method)) + " knows limits, not the spectral radius",
                       "Take output = \"boundary\"");
  }
}

/// With the limits at their speeds.
void add_points(const LobesProblem& problem, const LobesOptions& options, LobesResult& result, Progress& progress) {
  if (options.points.empty()) return;
  double deepest_m = options.axial_depth_m[1];
  std::vector<double> speeds;
  for (const OperatingPoint& point : options.points) {
    deepest_m = std::max(deepest_m, point.axial_depth_m);
    speeds.push_back(point.spindle_speed_rad_per_s);
  }
  const std::vector<FrequencyLimit> limits = solve(problem, options, speeds, deepest_m, false, progress);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const bool limited = limits[i].status != FrequencyLimit::Status::stable_in_range;
    PointResult& point = result.points.emplace_back(to_point(limits[i], options.points[i]));
    point.limit_depth_m = limited ? limits[i].axial_depth_m : std::numeric_limits<double>::infinity();
  }
}

}  // namespace

std::vector<Limit> frequency_limits(const LobesProblem& problem, const LobesOptions& options,
                                    const std::vector<double>& spindle_speeds_rad_per_s, Progress& progress) {
  std::vector<Limit> limits;
  for (const FrequencyLimit& found :
       solve(problem, options, spindle_speeds_rad_per_s, options.axial_depth_m[1], false, progress)) {
    limits.push_back(to_limit(found));
  }
  return limits;
}

PointResult frequency_point(const LobesProblem& problem, const LobesOptions& options, const OperatingPoint& point) {
  constexpr double least_m = 1e-9;
  const std::vector<FrequencyLimit> found = solve(problem, options, {point.spindle_speed_rad_per_s},
                                                  std::max(point.axial_depth_m, least_m), false, Progress::none());
  return to_point(found.front(), point);
}

LobesResult frequency_lobes(const LobesProblem& problem, const LobesOptions& options, Progress& progress) {
  require_depth(options);
  const Axes axes = even_axes(options);
  LobesResult result;
  result.method = options.method;
  result.period = problem.milling.tool.has_equal_pitch() ? Period::tooth : Period::revolution;
  result.spindle_speed_rad_per_s =
      Eigen::Map<const Eigen::VectorXd>(axes.spindle_speed_rad_per_s.data(), options.grid[0]);
  result.axial_depth_m = Eigen::Map<const Eigen::VectorXd>(axes.axial_depth_m.data(), options.grid[1]);
  const std::vector<FrequencyLimit> found =
      solve(problem, options, axes.spindle_speed_rad_per_s, options.axial_depth_m[1],
            options.output == Output::boundary, progress);
  for (const FrequencyLimit& limit : found) {
    result.limit.push_back(to_limit(limit));
    if (limit.status == FrequencyLimit::Status::not_converged) ++result.uncertain;
    if (options.output == Output::limits) continue;
    for (const DepthCrossing& crossing : limit.crossings) {
      if (crossing.axial_depth_m < options.axial_depth_m[0]) continue;
      result.boundary.push_back(
          {limit.spindle_speed_rad_per_s, crossing.axial_depth_m, crossing.chatter_frequency_hz, crossing.kind,
           crossing.axial_depth_m == limit.axial_depth_m ? limit.mode : modal::ModeId{}, error_share(limit), 0});
    }
  }
  add_points(problem, options, result, progress);
  result.evaluations = static_cast<long long>(found.size() + options.points.size());
  return result;
}

}  // namespace robomill::stability::detail
