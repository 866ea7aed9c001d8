#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability {

modal::TipModes tip_modes(const LobesProblem& problem) {
  const double feed_rad = problem.feed_direction_rad;
  modal::TipModes tool = modal::tip_modes(problem.dynamics, problem.keep_modes, feed_rad);
  if (problem.workpiece_dynamics.modes.empty()) return tool;
  return modal::joined(tool, modal::tip_modes(problem.workpiece_dynamics, {}, feed_rad, modal::ModeOwner::workpiece));
}

namespace detail {

template <int D>
TipDynamicsIn<D> tip_dynamics(const modal::TipModes& modes) {
  TipDynamicsIn<D> tip;
  tip.pole = modes.pole;
  tip.right = modes.right.template topRows<D>();
  tip.left = modes.left.template topRows<D>();
  tip.compliance = modes.compliance.template topLeftCorner<D, D>();
  tip.id = modes.id;
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const double size = 2.0 * tip.right.col(k).norm();
    if (size == 0.0) continue;
    tip.right.col(k) /= size;
    tip.left.col(k) *= size;
  }
  return tip;
}
template TipDynamicsIn<2> tip_dynamics<2>(const modal::TipModes& modes);
template TipDynamicsIn<3> tip_dynamics<3>(const modal::TipModes& modes);

TipDynamics tip_dynamics(const LobesProblem& problem) {
  return tip_dynamics<2>(tip_modes(problem));
}

}  // namespace detail
}  // namespace robomill::stability
