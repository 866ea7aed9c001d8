#include "robomill/stability/tip_dynamics.hpp"

#include <cmath>
#include <complex>
#include <numeric>
#include <set>

#include "robomill/base/error.hpp"

namespace robomill::stability::detail {
namespace {

using modal::Axis;
using modal::Dof;

bool in_plane(const Dof& dof) {
  return dof.axis == Axis::x || dof.axis == Axis::y;
}

int tip_point(const modal::ModalModel& model) {
  std::set<int> points;
  for (const auto* dofs : {&model.excitations, &model.responses}) {
    for (const Dof& dof : *dofs) {
      if (in_plane(dof)) points.insert(dof.point);
    }
  }
  if (points.empty()) throw InvalidInput("modes", "must know x or y at the tool tip");
  if (points.size() > 1 && !points.contains(0)) {
    throw InvalidInput("modes", "name several points, none of them the tool tip", "The tip carries no number");
  }
  return *points.begin();
}

/// The x and y entries of a vector over dofs; zero where there is none.
Eigen::Vector2cd at_tip(const Eigen::VectorXcd& vector, const std::vector<Dof>& dofs, int point) {
  Eigen::Vector2cd xy = Eigen::Vector2cd::Zero();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    if (dofs[i].point != point || !in_plane(dofs[i])) continue;
    xy(dofs[i].axis == Axis::x ? 0 : 1) = vector(static_cast<Eigen::Index>(i));
  }
  return xy;
}

std::vector<int> kept(const LobesProblem& problem) {
  if (!problem.keep_modes.empty()) return problem.keep_modes;
  std::vector<int> all(problem.dynamics.modes.size());
  std::iota(all.begin(), all.end(), 1);
  return all;
}

}  // namespace

TipDynamics tip_dynamics(const LobesProblem& problem) {
  const modal::ModalModel& model = problem.dynamics;
  const int point = tip_point(model);
  const double c = std::cos(problem.feed_direction_rad);
  const double s = std::sin(problem.feed_direction_rad);
  Eigen::Matrix2d to_feed;
  to_feed << c, s, -s, c;

  TipDynamics tip;
  tip.number = kept(problem);
  const Eigen::Index n = static_cast<Eigen::Index>(tip.number.size());
  tip.pole.resize(n);
  tip.right.resize(2, n);
  tip.left.resize(2, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const modal::Mode& mode = model.modes[static_cast<std::size_t>(tip.number[static_cast<std::size_t>(k)] - 1)];
    const Eigen::Vector2cd right = to_feed * at_tip(mode.right, model.responses, point);
    const Eigen::Vector2cd left = to_feed * at_tip(mode.left, model.excitations, point);
    const double size = 2.0 * right.norm();
    const double scale = size > 0.0 ? size : 1.0;
    tip.pole(k) = modal::pole(mode);
    tip.right.col(k) = right / scale;
    tip.left.col(k) = left * scale;
  }

  tip.compliance.setZero();
  for (const modal::Residual& residual : model.residuals) {
    const auto& [response, excitation] = residual.name;
    const bool at_point = response.point == point && excitation.point == point;
    if (!at_point || !in_plane(response) || !in_plane(excitation)) continue;
    tip.compliance(response.axis == Axis::x ? 0 : 1, excitation.axis == Axis::x ? 0 : 1) = residual.stiffness.real();
  }
  tip.compliance = (to_feed * tip.compliance * to_feed.transpose()).eval();
  return tip;
}

}  // namespace robomill::stability::detail
