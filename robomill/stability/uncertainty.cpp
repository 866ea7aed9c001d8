#include "robomill/stability/uncertainty.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/cutting/polynomial.hpp"
#include "robomill/stability/chart/chart.hpp"
#include "robomill/stability/chart/cost.hpp"

namespace robomill::stability {
namespace {

using namespace detail;

void require_ratio(const char* field, double ratio, double most) {
  if (!(ratio >= 0.0 && ratio <= most)) {
    throw InvalidInput(field, ratio, "", most < 1.0 ? "must lie between 0 and 0.5" : "must lie between 0 and 1",
                       "It is a share of the value, not a percentage");
  }
}

/// Drawn values stay on their own side of zero: a tenth of the value at least.
double drawn(Random& random, double value, double deviation) {
  const double sample = value + deviation * random.normal();
  if (value < 0.0) return std::min(sample, 0.1 * value);
  return value > 0.0 ? std::max(sample, 0.1 * value) : sample;
}

double known_or(double own, double other) {
  return std::isfinite(own) ? own : other;
}

void draw_modes(Random& random, const Uncertainty& u, modal::ModalModel& model) {
  for (modal::Mode& mode : model.modes) {
    const double damping_std = known_or(mode.damping_ratio_std, u.damping_std_ratio * mode.damping_ratio);
    mode.frequency_hz =
        drawn(random, mode.frequency_hz, known_or(mode.frequency_std_hz, u.frequency_std_ratio * mode.frequency_hz));
    mode.damping_ratio = std::min(drawn(random, mode.damping_ratio, damping_std), 0.99);
    mode.right *= drawn(random, 1.0, known_or(mode.residue_std_ratio, u.residue_std_ratio));
  }
}

/// A polynomial moves as a whole, by no more than leaves a tenth of its value at the side of the cutter.
void draw_coefficient(Random& random, double deviation, std::vector<double>& k) {
  const double side = cutting::detail::polynomial(k, 0.5 * std::numbers::pi);
  const double after = drawn(random, side, deviation);
  if (!k.empty()) k.back() += after - side;
}

/// All coefficients together: a material is harder or softer than it is said to be.
void scale_coefficients(double factor, LobesProblem& problem) {
  if (problem.spatial) {
    cutting::MillingCoefficients& k = problem.spatial->coefficients;
    for (std::vector<double>* const polynomial : {&k.tangential_n_per_m2, &k.radial_n_per_m2, &k.axial_n_per_m2}) {
      for (double& value : *polynomial) value *= factor;
    }
    return;
  }
  cutting::ForceCoefficients& k = problem.drilling ? problem.drilling->coefficients : problem.milling.coefficients;
  k.tangential_n_per_m2 *= factor;
  k.radial_n_per_m2 *= factor;
}

LobesProblem draw(const LobesProblem& problem, const Uncertainty& u, std::uint64_t sample) {
  Random random(u.seed, sample);
  LobesProblem one = problem;
  if (one.spatial) {
    draw_coefficient(random, u.tangential_std_n_per_m2, one.spatial->coefficients.tangential_n_per_m2);
    draw_coefficient(random, u.radial_std_n_per_m2, one.spatial->coefficients.radial_n_per_m2);
  } else {
    cutting::ForceCoefficients& k = one.drilling ? one.drilling->coefficients : one.milling.coefficients;
    k.tangential_n_per_m2 = drawn(random, k.tangential_n_per_m2, u.tangential_std_n_per_m2);
    k.radial_n_per_m2 = drawn(random, k.radial_n_per_m2, u.radial_std_n_per_m2);
  }
  draw_modes(random, u, one.dynamics);
  draw_modes(random, u, one.workpiece_dynamics);
  scale_coefficients(drawn(random, 1.0, u.coefficient_std_ratio), one);
  return one;
}

/// Of values in order; ranks count from 1.
double quantile(const std::vector<double>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace

void Uncertainty::validate() const {
  if (samples < 20) throw InvalidInput("samples", samples, "", "must be at least 20", "200 is usual");
  if (samples > 1'000'000) throw InvalidInput("samples", samples, "", "must be at most 1000000");
  for (const int points : grid) {
    if (points < 2 || points > 20000) throw InvalidInput("grid", points, "", "must lie between 2 and 20000");
  }
  require_non_negative("tangential_std_n_per_m2", tangential_std_n_per_m2, "N/m^2");
  require_non_negative("radial_std_n_per_m2", radial_std_n_per_m2, "N/m^2");
  require_ratio("coefficient_std_ratio", coefficient_std_ratio, 1.0);
  require_ratio("frequency_std_ratio", frequency_std_ratio, 0.5);
  require_ratio("damping_std_ratio", damping_std_ratio, 1.0);
  require_ratio("residue_std_ratio", residue_std_ratio, 1.0);
}

namespace {

Axes axes_of(const LobesOptions& options, const Uncertainty& uncertainty) {
  LobesOptions chart = options;
  chart.grid = uncertainty.grid;
  return column_axes(chart, even(chart.spindle_speed_rad_per_s, chart.grid[0]));
}

}  // namespace

Cost cost_of_uncertain_limits(const LobesProblem& problem, const LobesOptions& options,
                              const Uncertainty& uncertainty) {
  constexpr double usual_samples = 200.0, usual_speeds = 100.0, usual_depths = 100.0;
  const double samples = uncertainty.samples, columns = uncertainty.grid[0], depths = uncertainty.grid[1];
  const CostDriver counted =
      dominant_of({{.field = "samples", .value = samples, .times_usual = samples / usual_samples},
                   {.field = "grid",
                    .value = std::max(columns, depths),
                    .times_usual = std::max(columns / usual_speeds, columns * depths / usual_speeds / usual_depths)}});
  return cost_of_looks(problem, options, axes_of(options, uncertainty).spindle_speed_rad_per_s,
                       {.a_speed = looks_a_limit,
                        .times = samples,
                        .bytes = 8.0 * samples * columns + 60.0 * columns * depths,
                        .counted = counted});
}

UncertainLimits uncertain_limits(const LobesProblem& problem, const LobesOptions& options,
                                 const Uncertainty& uncertainty, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  problem.validate();
  options.validate();
  uncertainty.validate();
  const Axes axes = axes_of(options, uncertainty);
  const ThreadLimit threads(require_affordable(cost_of_uncertain_limits(problem, options, uncertainty)));
  const std::size_t speeds = axes.spindle_speed_rad_per_s.size();
  const std::size_t count = static_cast<std::size_t>(uncertainty.samples);
  constexpr double none = std::numeric_limits<double>::infinity();
  std::vector<double> depth_m(speeds * count, none);  // [speed][sample]
  progress.start("uncertain limits", count);
  parallel_for(count, 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::unique_ptr<Scheme> scheme = make_scheme(draw(problem, uncertainty, i), options);
      scheme->expect(axes.axial_depth_m, axes.fine > 1);
      const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
      const std::vector<Limit> limits = limits_between(*evaluator, axes, 0, speeds, options.tolerance, progress);
      for (std::size_t s = 0; s < speeds; ++s) {
        if (limits[s].status == Limit::Status::found) depth_m[s * count + i] = limits[s].axial_depth_m;
      }
      progress.advance();
    }
  });

  UncertainLimits result;
  const Eigen::Index n = static_cast<Eigen::Index>(speeds);
  const Eigen::Index m = uncertainty.grid[1];
  result.samples = uncertainty.samples;
  result.spindle_speed_rad_per_s = Eigen::Map<const Eigen::VectorXd>(axes.spindle_speed_rad_per_s.data(), n);
  result.axial_depth_m = to_eigen(even(options.axial_depth_m, uncertainty.grid[1]));
  result.limit_5_percent_m.resize(n);
  result.limit_50_percent_m.resize(n);
  result.limit_95_percent_m.resize(n);
  result.chatter_probability.resize(m, n);
  for (Eigen::Index s = 0; s < n; ++s) {
    const auto from = depth_m.begin() + s * static_cast<std::ptrdiff_t>(count);
    std::vector<double> sorted(from, from + static_cast<std::ptrdiff_t>(count));
    std::ranges::sort(sorted);
    result.limit_5_percent_m(s) = quantile(sorted, 0.05);
    result.limit_50_percent_m(s) = quantile(sorted, 0.5);
    result.limit_95_percent_m(s) = quantile(sorted, 0.95);
    for (Eigen::Index d = 0; d < m; ++d) {
      const auto above = std::ranges::upper_bound(sorted, result.axial_depth_m(d));
      result.chatter_probability(d, s) = static_cast<double>(above - sorted.begin()) / static_cast<double>(count);
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace robomill::stability
