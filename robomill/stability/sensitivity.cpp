#include "robomill/stability/sensitivity.hpp"

#include <array>
#include <cmath>
#include <memory>

#include "robomill/base/error.hpp"
#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/collocation/mode_sensitivity.hpp"

namespace robomill::stability {
namespace {

using namespace detail;

/// ∂ ln|μ| / ∂ ln a by two depths beside the point.
double by_depth(CollocationEvaluator& evaluator, const OperatingPoint& point, int level) {
  constexpr double step = 1e-3;
  std::array<OperatingPoint, 2> beside = {point, point};
  beside[0].axial_depth_m *= 1.0 - step;
  beside[1].axial_depth_m *= 1.0 + step;
  std::array<Outcome, 2> outcomes;
  evaluator.evaluate(beside, {.level = level}, outcomes);
  return std::log(outcomes[1].spectral_radius / outcomes[0].spectral_radius) / (2.0 * step);
}

double square(double x) {
  return x * x;
}

double known(double deviation) {
  return std::isfinite(deviation) ? deviation : 0.0;
}

}  // namespace

LimitSensitivity limit_sensitivity(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  problem.validate();
  LobesOptions checked;
  checked.spindle_speed_rad_per_s = {1.0, 2.0};
  checked.axial_depth_m = {0.0, 0.1};
  checked.tolerance = tolerance;
  checked.points = {point};
  checked.validate();
  require_known(problem, Method::collocation);
  const std::unique_ptr<CollocationModel> model = collocation_model(problem);
  CollocationEvaluator evaluator(*model, tolerance);
  const int level = model->first_level(point, tolerance) + 1;
  LimitSensitivity out;
  out.depth = by_depth(evaluator, point, level);
  CollocationCase at;
  model->prepare(point, mesh_level(level), at);
  if (!knows_sensitivities(problem, at)) {
    out.modes = mode_differences(problem, point, level, tolerance);
    return out;
  }
  Outcome outcome;
  evaluator.evaluate({&point, 1}, {.level = level}, {&outcome, 1});
  out.modes = mode_sensitivities(problem, at, eigen_motion(at, model->factor(point), outcome.multiplier));
  return out;
}

LimitQuantiles limit_quantiles(const LobesProblem& problem, const LimitSensitivity& sensitivity, double limit_m) {
  constexpr double quantile_95 = 1.6448536269514722;  // of the normal distribution
  double variance = 0.0;
  for (const LimitSensitivity::OfMode& of : sensitivity.modes) {
    const modal::ModalModel& model =
        of.mode.of == modal::ModeOwner::tool ? problem.dynamics : problem.workpiece_dynamics;
    const modal::Mode& mode = model.modes[static_cast<std::size_t>(of.mode.number) - 1];
    variance += square(of.frequency * known(mode.frequency_std_hz) / mode.frequency_hz) +
                square(of.damping_ratio * known(mode.damping_ratio_std) / mode.damping_ratio) +
                square(of.residue * known(mode.residue_std_ratio));
  }
  LimitQuantiles out = {limit_m, limit_m, limit_m, 0.0};
  if (!(sensitivity.depth > 0.0)) return out;
  out.log_std = std::sqrt(variance) / sensitivity.depth;
  out.limit_5_percent_m = limit_m * std::exp(-quantile_95 * out.log_std);
  out.limit_95_percent_m = limit_m * std::exp(quantile_95 * out.log_std);
  return out;
}

}  // namespace robomill::stability
