#include "robomill/stability/regime.hpp"

#include <memory>

#include "robomill/base/units.hpp"
#include "robomill/stability/chart/gain_search.hpp"
#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/collocation/eigen_motion.hpp"
#include "robomill/stability/collocation/regime_of.hpp"

namespace robomill::stability {

std::string_view to_string(Regime regime) {
  return name_in(regime_names, regime);
}

namespace detail {

RegimeResult regime_of(const LobesProblem& problem, const CollocationCase& at, double factor,
                       double spindle_speed_rad_per_s, double chatter_frequency_hz) {
  constexpr double few_waves = 0.5;
  constexpr double many_waves = 3.0;
  RegimeResult result;
  int teeth = problem.milling.tool.teeth;
  if (problem.spatial) teeth = problem.spatial->cutter.mill.teeth;
  if (problem.drilling) teeth = problem.drilling->lips;
  const double delay_s = units::revolution / (teeth * spindle_speed_rad_per_s);
  result.without_delay = radius_without_delay(at, factor);
  result.waves_between_teeth = chatter_frequency_hz * delay_s;
  result.regime = Regime::regenerative;
  if (result.waves_between_teeth < few_waves) result.regime = Regime::low_frequency;
  if (result.without_delay >= 1.0) result.regime = Regime::mode_coupling;
  const bool damped = !problem.in_three_directions() && problem.milling.process_damping.active();
  result.lower_bound = !damped && result.waves_between_teeth > many_waves;
  return result;
}

}  // namespace detail

RegimeResult regime_at(const LobesProblem& problem, const OperatingPoint& point, double tolerance) {
  const PointResult with = evaluate_point(problem, {.tolerance = tolerance}, point);
  if (with.spectral_radius < 1.0 - tolerance) return {};
  const std::unique_ptr<detail::CollocationModel> model = detail::collocation_model(problem);
  detail::CollocationCase at;
  model->prepare(point, detail::mesh_level(model->first_level(point, tolerance)), at);
  return detail::regime_of(problem, at, model->factor(point), point.spindle_speed_rad_per_s, with.chatter_frequency_hz);
}

}  // namespace robomill::stability
