#include "robomill/stability/time_steps/speed_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "robomill/stability/time_steps/piece_plan.hpp"

namespace robomill::stability::detail {

Resolution resolution(const TipDynamics& tip, double step_s, double largest_n_per_m) {
  double square = 0.0;
  double shift = 0.0;
  Eigen::Matrix2d jump = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    square = std::max(square, std::norm(tip.pole(k)));
    shift += std::abs(tip.pole(k)) * 2.0 * tip.right.col(k).norm() * tip.left.col(k).norm();
    jump += 2.0 * (tip.right.col(k) * tip.left.col(k).transpose()).real();
  }
  // How fast the structure moves while the cut holds it: its poles, stiffened by the cut.
  const double rate = std::sqrt(square + shift * largest_n_per_m) + jump.norm() * largest_n_per_m;
  // Gauss collocation: error x^(2p+1) (p!)^4 / ((2p+1) (2p)!^3) <= 1e-13 for x up to:
  constexpr std::array<double, 4> reach = {0.10, 0.38, 0.90, 1.6};  // p = 3, 4, 5, 6
  constexpr int most = 6;
  Resolution r;
  double x = rate * step_s;
  while (x > reach.back() && r.halvings < 30) {
    x *= 0.5;
    ++r.halvings;
  }
  while (r.nodes < most && x > reach[static_cast<std::size_t>(r.nodes - 3)]) ++r.nodes;
  return r;
}

void plan_speed(const TipDynamics& tip, double step_s, const Resolution& resolution, SpeedPlan& out) {
  const double h = std::ldexp(step_s, -resolution.halvings);
  PiecePlan piece;
  plan_piece(tip, Rotation(1.0, {}), 0.0, h, resolution.nodes, false, piece);
  out.step_s = step_s;
  out.resolution = resolution;
  out.substep = piece.factor;
  out.step.resize(tip.pole.size());
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) out.step(k) = std::exp(tip.pole(k) * step_s);
  out.at_nodes = piece.at_nodes;
  out.response = piece.response;
  out.influence = piece.influence;
}

}  // namespace robomill::stability::detail
