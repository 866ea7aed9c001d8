#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/stability/rotation.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// What a piece of the rotation does to the structure, for a force that is a polynomial through its values f_j at p
/// Gauss points of the angle: z(end) = E z + Σ_j W_j f_j; displacements there q_i = V_i z + Σ_j G_ij f_j, velocities
/// likewise, in D directions. z in real form is Re z_1, Im z_1, Re z_2, …; every integral of the exponentials is exact
/// to rounding.
struct PiecePlan {
  double length_rad = 0.0;
  double duration_s = 0.0;
  std::vector<double> time_s;    ///< length p: nodes, from the start of the piece
  std::vector<double> weight_s;  ///< length p: of the nodes, for integrals over the piece
  Eigen::VectorXcd factor;       ///< length n: exp(pole duration)
  Eigen::MatrixXd at_nodes;      ///< V, Dp x 2n
  Eigen::MatrixXd response;      ///< G, Dp x Dp [m/N], without the static compliance
  Eigen::MatrixXd influence;     ///< W, 2n x Dp [m/N]
  /// Dp x 2n and Dp x Dp, the same for velocities; empty unless asked for. [1/s], [m/(N s)]
  Eigen::MatrixXd velocity_at_nodes, velocity_response;
  [[nodiscard]] int nodes() const { return static_cast<int>(time_s.size()); }
};

inline constexpr int most_nodes = 16;

/// @param nodes  p, 1 to most_nodes; the piece should be no longer than 8 rad of the fastest mode
template <int D>
void plan_piece(const TipDynamicsIn<D>& tip, const Rotation& rotation, double from_rad, double length_rad, int nodes,
                bool velocities, PiecePlan& out);
extern template void plan_piece<2>(const TipDynamicsIn<2>&, const Rotation&, double, double, int, bool, PiecePlan&);
extern template void plan_piece<3>(const TipDynamicsIn<3>&, const Rotation&, double, double, int, bool, PiecePlan&);

}  // namespace robomill::stability::detail
