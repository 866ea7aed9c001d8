#include "robomill/stability/lobes.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/stability/chart.hpp"
#include "robomill/stability/evaluator.hpp"

namespace robomill::stability {
namespace {

using namespace detail;

std::vector<double> even(const std::array<double, 2>& range, int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    values[static_cast<std::size_t>(i)] = (1.0 - t) * range[0] + t * range[1];
  }
  return values;
}

/// With a helix the stiffness takes time to find; it is kept where that does not cost much memory.
std::vector<DepthPlan> depth_plans(const Model& model, bool helix, const std::vector<double>& depths_m) {
  std::vector<DepthPlan> plans;
  const std::size_t matrices =
      depths_m.size() * static_cast<std::size_t>(model.cut.steps()) * model.cut.delays().size();
  if (!helix || matrices > 4'000'000) return plans;
  plans.resize(depths_m.size());
  parallel_for(depths_m.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) model.cut.at_depth(depths_m[j], plans[j]);
  });
  return plans;
}

struct Count {
  long long evaluations = 0, unsettled = 0;
  void add(const Evaluator& evaluator) {
    evaluations += evaluator.evaluations();
    unsettled += evaluator.unsettled();
  }
};

std::vector<Column> columns(const Model& model, const LobesProblem& problem, const LobesOptions& options,
                            const std::vector<double>& speeds, const std::vector<double>& depths_m, Look look,
                            Count& count, Progress& progress) {
  const std::vector<DepthPlan> plans = depth_plans(model, problem.milling.tool.helix_rad != 0.0, depths_m);
  std::vector<Column> result(speeds.size());
  std::vector<Count> counts(speeds.size());
  progress.start("stability lobes", speeds.size());
  parallel_for(speeds.size(), 4, [&](std::size_t begin, std::size_t end) {
    Evaluator evaluator(model);
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = column(evaluator, speeds[i], depths_m, plans, options.tolerance, look, progress);
      progress.advance();
    }
    counts[begin].add(evaluator);
  });
  for (const Count& c : counts) {
    count.evaluations += c.evaluations;
    count.unsettled += c.unsettled;
  }
  return result;
}

/// Crossings between neighbouring speeds at the same depth.
std::vector<BoundaryPoint> across_speeds(const Model& model, const LobesOptions& options, const LobesResult& chart,
                                         Count& count, Progress& progress) {
  std::vector<Edge> edges;
  for (Eigen::Index i = 0; i + 1 < chart.spectral_radius.cols(); ++i) {
    for (Eigen::Index j = 0; j < chart.spectral_radius.rows(); ++j) {
      const double left = chart.spectral_radius(j, i);
      const double right = chart.spectral_radius(j, i + 1);
      if ((left < 1.0) == (right < 1.0)) continue;
      edges.push_back({{chart.spindle_speed_rad_per_s(i), chart.axial_depth_m(j)},
                       {chart.spindle_speed_rad_per_s(i + 1), chart.axial_depth_m(j)},
                       left,
                       right});
    }
  }
  std::vector<BoundaryPoint> result(edges.size());
  std::vector<Count> counts(edges.size());
  progress.start("stability boundary", edges.size());
  parallel_for(edges.size(), 4 * lane_count, [&](std::size_t begin, std::size_t end) {
    Evaluator evaluator(model);
    const auto at = [](auto& list, std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::vector<Edge> mine(at(edges, begin), at(edges, end));
    const std::vector<BoundaryPoint> found = refine(evaluator, mine, options.tolerance, progress);
    std::ranges::copy(found, at(result, begin));
    counts[begin].add(evaluator);
    progress.advance(end - begin);
  });
  for (const Count& c : counts) {
    count.evaluations += c.evaluations;
    count.unsettled += c.unsettled;
  }
  return result;
}

PointResult point_result(const LobesProblem& problem, const LobesOptions& options, const Model& model,
                         const OperatingPoint& point) {
  const Evaluator::Point at{point.spindle_speed_rad_per_s, point.axial_depth_m, nullptr};
  Evaluator evaluator(model);
  Dominant dominant, finer;
  Motion motion;
  evaluator.evaluate({&at, 1}, {&dominant, 1});
  evaluator.describe({&dominant, 1}, {&motion, 1});
  // The error falls with the square of the step, so that of the finer run is a third of what the two differ by.
  const Model fine(problem, 2 * options.intervals);
  Evaluator(fine).evaluate({&at, 1}, {&finer, 1});
  PointResult result;
  result.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  result.axial_depth_m = point.axial_depth_m;
  result.spectral_radius = spectral_radius(dominant);
  result.multiplier = std::isfinite(std::abs(dominant.multiplier)) ? dominant.multiplier : result.spectral_radius;
  result.stable = result.spectral_radius < 1.0;
  result.error_estimate = 4.0 / 3.0 * std::abs(spectral_radius(finer) - result.spectral_radius);
  result.chatter_frequency_hz = motion.frequency_hz;
  result.kind = kind_of(dominant.multiplier);
  result.mode = motion.mode;
  return result;
}

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

LobesResult compute_lobes(const LobesProblem& problem, const LobesOptions& options, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  problem.validate();
  options.validate();
  const Model model(problem, options.intervals);
  const std::vector<double> speeds = even(options.spindle_speed_rad_per_s, options.grid[0]);
  const std::vector<double> depths = even(options.axial_depth_m, options.grid[1]);
  LobesResult result;
  result.spindle_speed_rad_per_s = to_eigen(speeds);
  result.axial_depth_m = to_eigen(depths);
  result.method = options.method;
  result.period = model.cut.period();
  Count count;
  const bool map = options.output == Output::map;
  const std::vector<Column> found =
      columns(model, problem, options, speeds, depths, map ? Look::map : Look::boundary, count, progress);
  result.spectral_radius.resize(options.grid[1], options.grid[0]);
  for (std::size_t i = 0; i < found.size(); ++i) {
    result.spectral_radius.col(static_cast<Eigen::Index>(i)) = to_eigen(found[i].spectral_radius);
    result.limit.push_back(found[i].limit);
  }
  if (!map) {
    result.boundary = across_speeds(model, options, result, count, progress);
    for (const Column& c : found) result.boundary.insert(result.boundary.end(), c.boundary.begin(), c.boundary.end());
    std::ranges::sort(result.boundary, [](const BoundaryPoint& a, const BoundaryPoint& b) {
      return std::pair(a.spindle_speed_rad_per_s, a.axial_depth_m) <
             std::pair(b.spindle_speed_rad_per_s, b.axial_depth_m);
    });
  }
  for (const OperatingPoint& point : options.points) {
    progress.check();
    result.points.push_back(point_result(problem, options, model, point));
  }
  result.evaluations = count.evaluations + 2 * static_cast<long long>(options.points.size());
  result.unsettled = count.unsettled;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

PointResult evaluate_point(const LobesProblem& problem, const LobesOptions& options, const OperatingPoint& point) {
  problem.validate();
  LobesOptions checked = options;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.axial_depth_m = {0.0, 0.1};
  checked.points = {point};
  checked.validate();
  return point_result(problem, options, Model(problem, options.intervals), point);
}

std::vector<Limit> limit_depths(const LobesProblem& problem, const LobesOptions& options,
                                const std::vector<double>& spindle_speeds_rad_per_s, Progress& progress) {
  problem.validate();
  LobesOptions checked = options;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.validate();
  for (const double speed : spindle_speeds_rad_per_s) require_positive("spindle_speed_rad_per_s", speed, "rad/s");
  const Model model(problem, options.intervals);
  const std::vector<double> depths = even(options.axial_depth_m, options.grid[1]);
  Count count;
  const std::vector<Column> found =
      columns(model, problem, options, spindle_speeds_rad_per_s, depths, Look::limit, count, progress);
  std::vector<Limit> limits;
  for (const Column& c : found) limits.push_back(c.limit);
  return limits;
}

}  // namespace robomill::stability
