#include "robomill/stability/collocation/mode_sensitivity.hpp"

#include <array>
#include <cmath>
#include <memory>

#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;
using OfMode = LimitSensitivity::OfMode;

constexpr double pole_step = 1e-6;  // relative: rounding and curvature are both below 1e-5

/// One mode of a structure, without compliance.
template <int D>
TipDynamicsIn<D> single(const TipDynamicsIn<D>& tip, Eigen::Index k, Complex pole) {
  TipDynamicsIn<D> one;
  one.pole = Eigen::VectorXcd::Constant(1, pole);
  one.right = tip.right.col(k);
  one.left = tip.left.col(k);
  one.compliance.setZero();
  return one;
}

/// yᵀ δΨ z of one mode, whose plans change by (after - before) / step; of both matrices that lead into the mode alone
/// where `residue`.
class Answer {
 public:
  Answer(const CollocationCase& at, const EigenMotion& motion, Eigen::Index mode)
      : at_(at), motion_(motion), mode_(mode) {}

  [[nodiscard]] Complex of_pole(const std::vector<PiecePlan>& before, const std::vector<PiecePlan>& after,
                                double step) const {
    Complex sum = 0.0;
    for (std::size_t e = 0; e < at_.pieces.size(); ++e) {
      const PiecePlan& p = before[at_.pieces[e].plan];
      const PiecePlan& q = after[at_.pieces[e].plan];
      const EigenMotion::Piece& piece = motion_.pieces[e];
      const Eigen::Vector2cd z = piece.start.segment<2>(2 * mode_);
      const Eigen::Vector2cd y = piece.costate.segment<2>(2 * mode_);
      const Complex turn = q.factor(0) - p.factor(0);
      sum += y(0) * (turn.real() * z(0) - turn.imag() * z(1)) + y(1) * (turn.imag() * z(0) + turn.real() * z(1));
      if (piece.force.size() == 0) continue;
      const Complex strength = motion_.factor * motion_.nu;
      const Eigen::VectorXcd moved =
          (q.at_nodes - p.at_nodes) * z + strength * ((q.response - p.response) * piece.force);
      const Eigen::Vector2cd driven = (q.influence - p.influence) * piece.force;
      sum += strength * ((y.transpose() * driven).value() + (piece.seen.transpose() * moved).value());
    }
    return sum / step;
  }

  [[nodiscard]] Complex of_residue(const std::vector<PiecePlan>& plans) const {
    Complex sum = 0.0;
    const Complex strength = motion_.factor * motion_.nu;
    for (std::size_t e = 0; e < at_.pieces.size(); ++e) {
      const PiecePlan& p = plans[at_.pieces[e].plan];
      const EigenMotion::Piece& piece = motion_.pieces[e];
      if (piece.force.size() == 0) continue;
      const Eigen::VectorXcd moved = strength * (p.response * piece.force);
      const Eigen::Vector2cd driven = p.influence * piece.force;
      sum += strength * ((piece.costate.segment<2>(2 * mode_).transpose() * driven).value() +
                         (piece.seen.transpose() * moved).value());
    }
    return sum;
  }

 private:
  const CollocationCase& at_;
  const EigenMotion& motion_;
  Eigen::Index mode_;
};

template <int D>
std::vector<OfMode> sensitivities(const TipDynamicsIn<D>& tip, const CollocationCase& at, const EigenMotion& motion) {
  const Rotation turning(at.spindle_speed_rad_per_s, {});
  std::vector<OfMode> out;
  std::vector<double> length_rad(at.plans.size(), 0.0);
  std::vector<int> nodes(at.plans.size(), 1);
  for (std::size_t e = 0; e < at.pieces.size(); ++e) {
    length_rad[at.pieces[e].plan] = at.mesh.pieces[e].length_rad;
    if (at.mesh.topology.pieces[e].records) nodes[at.pieces[e].plan] = at.level.nodes;
  }
  const auto plans_of = [&](Eigen::Index k, Complex pole) {
    std::vector<PiecePlan> plans(at.plans.size());
    for (std::size_t i = 0; i < plans.size(); ++i) {
      plan_piece(single(tip, k, pole), turning, 0.0, length_rad[i], nodes[i], false, plans[i]);
    }
    return plans;
  };
  const Complex per_change = 1.0 / (motion.scale * motion.multiplier);
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const Complex pole = tip.pole(k);
    const double zeta = -pole.real() / std::abs(pole);
    // λ = ω (-ζ + i sqrt(1 - ζ²)): of ln ω it changes by λ, of ln ζ by i ζ / sqrt(1 - ζ²) λ.
    const Complex by_damping(0.0, zeta / std::sqrt(1.0 - zeta * zeta));
    const std::vector<PiecePlan> here = plans_of(k, pole);
    const std::vector<PiecePlan> quicker = plans_of(k, pole * (1.0 + pole_step));
    const std::vector<PiecePlan> damped = plans_of(k, pole * std::exp(by_damping * pole_step));
    const Answer answer(at, motion, k);
    out.push_back({.mode = tip.id[static_cast<std::size_t>(k)],
                   .frequency = (answer.of_pole(here, quicker, pole_step) * per_change).real(),
                   .damping_ratio = (answer.of_pole(here, damped, pole_step) * per_change).real(),
                   .residue = (answer.of_residue(here) * per_change).real()});
  }
  return out;
}

}  // namespace

bool knows_sensitivities(const LobesProblem& problem, const CollocationCase& at) {
  const bool even = problem.in_three_directions() || !problem.milling.speed_variation.active();
  return even && looks_back_a_period(at.mesh.topology);
}

std::vector<OfMode> mode_sensitivities(const LobesProblem& problem, const CollocationCase& at,
                                       const EigenMotion& motion) {
  if (problem.in_three_directions()) return sensitivities(tip_dynamics<3>(tip_modes(problem)), at, motion);
  return sensitivities(tip_dynamics(problem), at, motion);
}

std::vector<OfMode> mode_differences(const LobesProblem& problem, const OperatingPoint& point, int level,
                                     double tolerance) {
  constexpr double step = 1e-4;
  const auto log_radius = [&](const LobesProblem& changed) {
    const std::unique_ptr<Scheme> scheme = collocation(changed, tolerance);
    const std::unique_ptr<PointEvaluator> evaluator = scheme->evaluator();
    Outcome outcome;
    evaluator->evaluate({&point, 1}, {.level = level}, {&outcome, 1});
    return std::log(outcome.spectral_radius);
  };
  const auto slope = [&](const modal::ModeId& id, const auto& change) {
    std::array<double, 2> value = {};
    for (const int side : {0, 1}) {
      LobesProblem changed = problem;
      modal::ModalModel& model = id.of == modal::ModeOwner::tool ? changed.dynamics : changed.workpiece_dynamics;
      change(model.modes[static_cast<std::size_t>(id.number) - 1], side == 1 ? 1.0 + step : 1.0 - step);
      value[static_cast<std::size_t>(side)] = log_radius(changed);
    }
    return (value[1] - value[0]) / (2.0 * step);
  };
  std::vector<OfMode> out;
  for (const modal::ModeId& id : tip_modes(problem).id) {
    out.push_back({.mode = id,
                   .frequency = slope(id, [](modal::Mode& mode, double by) { mode.frequency_hz *= by; }),
                   .damping_ratio = slope(id, [](modal::Mode& mode, double by) { mode.damping_ratio *= by; }),
                   .residue = slope(id, [](modal::Mode& mode, double by) { mode.right *= by; })});
  }
  return out;
}

}  // namespace robomill::stability::detail
