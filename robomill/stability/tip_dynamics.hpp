#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/tip.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// The structure at the tool tip as the cut sees it, in the feed's frame:
/// q = 2 Re Σ_k right_k z_k + compliance F, dz_k/dt = pole_k z_k + left_k^T F.
///
/// Scaled so that ‖2 right_k‖ = 1: every z_k is then a displacement in m, whatever scale the mode came with.
struct TipDynamics {
  Eigen::VectorXcd pole;          ///< length n [rad/s]
  Eigen::Matrix2Xcd right;        ///< 2 x n, in x and y of the feed
  Eigen::Matrix2Xcd left;         ///< 2 x n [m/(N s)]
  Eigen::Matrix2d compliance;     ///< S, real part of the stiffness residuals [m/N]
  std::vector<modal::ModeId> id;  ///< length n: the workpiece's follow the tool's
};

/// Of these modes in the plane, or of the problem's.
/// @throws InvalidInput as tip_modes
TipDynamics tip_dynamics(const modal::TipModes& modes);
TipDynamics tip_dynamics(const LobesProblem& problem);

}  // namespace robomill::stability::detail
