#pragma once
#include <Eigen/Core>

#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// How finely the motion inside one time step is followed.
struct Resolution {
  int nodes = 3;     ///< p, Gauss points of a substep
  int halvings = 0;  ///< a step is 2^halvings substeps, put together by squaring
};

/// So fine that one step is right to about 1e-13 of its motion.
/// @param step_s  length of a time step
/// @param largest_n_per_m  greatest stiffness of the cut
Resolution resolution(const TipDynamics& tip, double step_s, double largest_n_per_m);

/// What one substep of length h does to the structure at one speed, for a force that is a polynomial through its values
/// f_j at p Gauss points: z(h) = E z + Σ_j W_j f_j, and displacements there q_i = V_i z + Σ_j G_ij f_j.
/// z in real form is Re z_1, Im z_1, Re z_2, …; every integral of the exponentials is exact to rounding.
struct SpeedPlan {
  double step_s = 0.0;
  Resolution resolution = {};
  Eigen::VectorXcd substep;   ///< length n: exp(pole h)
  Eigen::VectorXcd step;      ///< length n: exp(pole step_s)
  Eigen::MatrixXd at_nodes;   ///< V, 2p x 2n
  Eigen::MatrixXd response;   ///< G, 2p x 2p [m/N]
  Eigen::MatrixXd influence;  ///< W, 2n x 2p [m/N]
};

void plan_speed(const TipDynamics& tip, double step_s, const Resolution& resolution, SpeedPlan& out);

}  // namespace robomill::stability::detail
