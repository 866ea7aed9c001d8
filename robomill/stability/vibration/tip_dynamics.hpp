#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/tip.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// The structure at the tool tip as the cut sees it, in the cut's frame, in D = 2 or 3 directions:
/// q = 2 Re Σ_k right_k z_k + compliance F, dz_k/dt = pole_k z_k + left_k^T F.
///
/// Scaled so that ‖2 right_k‖ = 1: every z_k is then a displacement in m, whatever scale the mode came with.
template <int D>
struct TipDynamicsIn {
  Eigen::VectorXcd pole;                                         ///< length n [rad/s]
  Eigen::Matrix<std::complex<double>, D, Eigen::Dynamic> right;  ///< D x n
  Eigen::Matrix<std::complex<double>, D, Eigen::Dynamic> left;   ///< D x n [m/(N s)]
  Eigen::Matrix<double, D, D> compliance;                        ///< S, real part of the stiffness residuals [m/N]
  std::vector<modal::ModeId> id;                                 ///< length n: the workpiece's follow the tool's
};
/// In x and y of the feed.
using TipDynamics = TipDynamicsIn<2>;

/// The first D directions of these modes.
template <int D>
TipDynamicsIn<D> tip_dynamics(const modal::TipModes& modes);
extern template TipDynamicsIn<2> tip_dynamics<2>(const modal::TipModes& modes);
extern template TipDynamicsIn<3> tip_dynamics<3>(const modal::TipModes& modes);

/// Of the problem, in the plane.
/// @throws InvalidInput as tip_modes
TipDynamics tip_dynamics(const LobesProblem& problem);

}  // namespace robomill::stability::detail
