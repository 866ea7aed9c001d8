#include "robomill/stability/tip_dynamics.hpp"

#include "robomill/modal/tip.hpp"

namespace robomill::stability::detail {

TipDynamics tip_dynamics(const LobesProblem& problem) {
  modal::TipModes modes = modal::tip_modes(problem.dynamics, problem.keep_modes, problem.feed_direction_rad);
  if (!problem.workpiece_dynamics.modes.empty()) {
    modes = modal::joined(modes, modal::tip_modes(problem.workpiece_dynamics, {}, problem.feed_direction_rad));
  }
  TipDynamics tip;
  tip.pole = modes.pole;
  tip.right = modes.right.topRows<2>();
  tip.left = modes.left.topRows<2>();
  tip.compliance = modes.compliance.topLeftCorner<2, 2>();
  tip.number = modes.number;
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const double size = 2.0 * tip.right.col(k).norm();
    if (size == 0.0) continue;
    tip.right.col(k) /= size;
    tip.left.col(k) *= size;
  }
  return tip;
}

}  // namespace robomill::stability::detail
