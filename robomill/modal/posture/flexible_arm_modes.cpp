#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/modal/posture/flexible_arm.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using Kind = ArmParameter::Kind;

/// The velocity of a centre that moves out by a unit along an axis of its link, from the angular one.
template <class Matrix>
Matrix swung(const FlexibleArm::BodyMotion& body, std::size_t axis, const Matrix& turned) {
  return -cross_matrix(body.axes.col(static_cast<Eigen::Index>(axis))) * turned;
}

Eigen::Matrix3cd in_base(const FlexibleArm::System& system) {
  return (system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose()).cast<Complex>();
}

Eigen::MatrixXcd dynamic_stiffness(const FlexibleArm::System& system, Complex s) {
  return s * s * system.mass + s * system.damping + system.stiffness;
}

}  // namespace

Eigen::Matrix3Xcd FlexibleArm::pivot_change(const System& system, std::size_t axis, const Eigen::MatrixXcd& x) const {
  // A coordinate about e moves a point p by e x (p - pivot); the bracket's axes are the flange's.
  return system.flange_axes * cross_matrix(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis))) *
         x.middleRows(bracket_row_, 3);
}

Eigen::MatrixXcd FlexibleArm::mass_change(const System& system, const ArmParameter& parameter,
                                          const Eigen::MatrixXcd& x) const {
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(x.rows(), x.cols());
  if (parameter.kind == Kind::rotor_inertia) {
    const Eigen::Index c = joint_row(parameter.index);
    out.row(c) = system.rotor(c) * x.row(c);
    return out;
  }
  if (parameter.kind == Kind::tool_mass) {
    const ToolMotion& tool = system.tools[parameter.index];
    return tool.mass_kg * (tool.input * (tool.input.transpose() * x));
  }
  if (parameter.kind == Kind::bracket_pivot) {
    const Eigen::Matrix3Xcd moved = pivot_change(system, parameter.index, x);
    const Eigen::Matrix3d turn =
        -cross_matrix(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(parameter.index))) * system.flange_axes.transpose();
    const auto add = [&](double mass, const Eigen::MatrixXd& motion) {  // motion: 3 x n
      out += mass * (motion.transpose() * moved);
      out.middleRows(bracket_row_, 3) += mass * (turn * (motion * x));
    };
    for (const BodyMotion& body : system.bodies) {
      if (body.on_bracket) add(body.mass_kg, body.linear);
    }
    for (const ToolMotion& tool : system.tools) add(tool.mass_kg, tool.input.transpose());
    return out;
  }
  const BodyMotion& body = system.bodies[parameter.index];
  const Eigen::MatrixXcd turned = body.turning * x, moved = body.linear * x;
  if (parameter.kind == Kind::body_center) {
    const Eigen::Matrix3Xd arm = swung(body, parameter.axis, body.turning);
    return body.mass_kg * (arm.transpose() * moved + body.linear.transpose() * swung(body, parameter.axis, turned));
  }
  out = body.turning.transpose() * (body.inertia * turned);
  if (parameter.kind == Kind::body_mass) out += body.mass_kg * (body.linear.transpose() * moved);
  return out;
}

Eigen::Matrix3cd FlexibleArm::receptance(const System& system, Complex s) {
  const Eigen::MatrixXcd moved = dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  return system.input.transpose() * moved + in_base(system);
}

FlexibleArm::Modes FlexibleArm::modes(const System& system, double highest_hz) const {
  // In the undamped modes, of which those far above the band are left to the compliance.
  const Eigen::Index n = system.mass.rows();
  const Eigen::VectorXd scale = system.mass.diagonal().cwiseSqrt().cwiseInverse();
  const linear_algebra::SymmetricEigenPairs masses =
      linear_algebra::symmetric_eigen_pairs(scale.asDiagonal() * system.mass * scale.asDiagonal());
  const Eigen::MatrixXd root =
      scale.asDiagonal() * masses.vectors * masses.values.cwiseMax(1e-12).cwiseSqrt().cwiseInverse().asDiagonal();
  const linear_algebra::SymmetricEigenPairs undamped =
      linear_algebra::symmetric_eigen_pairs(root.transpose() * system.stiffness * root);
  const Eigen::MatrixXd shapes = root * undamped.vectors;
  const double beyond = std::pow(2.0 * std::numbers::pi * 2.5 * highest_hz, 2.0);
  Eigen::Index kept = 0;
  while (kept < n && undamped.values(kept) < beyond) ++kept;
  kept = std::clamp<Eigen::Index>(kept, 1, n);
  const Eigen::MatrixXd phi = shapes.leftCols(kept);
  const double rate = std::sqrt(std::max(undamped.values(kept - 1), 1e-12));
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * kept, 2 * kept);
  state.topRightCorner(kept, kept).setIdentity();
  state.bottomLeftCorner(kept, kept) = -(undamped.values.head(kept) / (rate * rate)).asDiagonal().toDenseMatrix();
  state.bottomRightCorner(kept, kept) = -(phi.transpose() * system.damping * phi) / rate;
  const linear_algebra::EigenPairs pairs = linear_algebra::eigen_pairs(state);
  std::vector<Eigen::Index> order;
  for (Eigen::Index k = 0; k < 2 * kept; ++k) {
    if (pairs.values(k).imag() > 0.0) order.push_back(k);
  }
  std::ranges::sort(order, {}, [&](Eigen::Index k) { return std::abs(pairs.values(k)); });
  const Eigen::Matrix3Xd at_tip = system.input.transpose() * phi;
  Eigen::Matrix3d all = system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose();
  all += system.input.transpose() * linear_algebra::solve(system.stiffness, system.input);
  Modes out;
  out.rest = all;
  std::vector<Eigen::Index> inside;
  for (const Eigen::Index k : order) {
    if (std::abs(pairs.values(k)) * rate <= 2.0 * std::numbers::pi * highest_hz) inside.push_back(k);
  }
  const Eigen::Index m = static_cast<Eigen::Index>(inside.size());
  out.pole.resize(m);
  out.shape.resize(n, m);
  out.at_tip.resize(3, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const Eigen::Index from = inside[static_cast<std::size_t>(k)];
    const Complex pole = pairs.values(from) * rate;
    Eigen::VectorXcd small = pairs.vectors.col(from).head(kept);
    const Eigen::VectorXcd whole = phi * small;
    const Complex norm =
        (whole.transpose() * system.damping * whole).value() + 2.0 * pole * (small.transpose() * small).value();
    const Complex root_norm = std::sqrt(norm);
    out.pole(k) = pole;
    out.shape.col(k) = whole / root_norm;
    out.at_tip.col(k) = at_tip * small / root_norm;
    out.rest += 2.0 * (out.at_tip.col(k) * out.at_tip.col(k).transpose() / pole).real();
  }
  return out;
}

FlexibleArm::Sensitivity FlexibleArm::sensitivity(const System& system, const Modes& modes) const {
  const Eigen::Index m = modes.pole.size();
  const Eigen::Index count = static_cast<Eigen::Index>(parameters_.size());
  Sensitivity out;
  out.log_frequency.setZero(m, count);
  out.damping_ratio.setZero(m, count);
  out.residue.assign(static_cast<std::size_t>(m), Eigen::MatrixXcd::Zero(9, count));
  // Modes in the band and their conjugates span the shapes' changes; what is beyond is far.
  const Eigen::Index n = modes.shape.rows();
  Eigen::MatrixXcd basis(n, 2 * m);
  basis << modes.shape, modes.shape.conjugate();
  Eigen::VectorXcd poles(2 * m);
  poles << modes.pole, modes.pole.conjugate();
  Eigen::Matrix3Xcd tips(3, 2 * m);
  tips << modes.at_tip, modes.at_tip.conjugate();
  for (Eigen::Index p = 0; p < count; ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == ArmParameter::Kind::compliance) continue;
    const SpringChange& spring = system.springs[static_cast<std::size_t>(p)];
    const bool mass = spring.count == 0;
    const Eigen::MatrixXcd moved = mass ? mass_change(system, parameter, modes.shape) : Eigen::MatrixXcd();
    const Eigen::Matrix3Xcd of_input = parameter.kind == ArmParameter::Kind::bracket_pivot
                                           ? pivot_change(system, parameter.index, modes.shape)
                                           : Eigen::Matrix3Xcd::Zero(3, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Complex pole = modes.pole(k);
      // u = (∂K + λ ∂C + λ² ∂M) ψ
      Eigen::VectorXcd projected;
      Complex self_norm = 0.0;
      if (mass) {
        projected = basis.transpose() * moved.col(k) * (pole * pole);
        self_norm = 2.0 * pole * (modes.shape.col(k).transpose() * moved.col(k)).value();
      } else {
        const Eigen::Index r = spring.first, n_rows = spring.count;
        const Eigen::VectorXcd own = modes.shape.col(k).segment(r, n_rows);
        const Eigen::MatrixXd damping = spring.damping.topLeftCorner(n_rows, n_rows);
        projected = basis.middleRows(r, n_rows).transpose() *
                    (spring.stiffness.topLeftCorner(n_rows, n_rows) * own + pole * (damping * own));
        self_norm = (own.transpose() * (damping * own)).value();
      }
      const Complex shift = -projected(k);  // dλ
      const double size = std::abs(pole);
      const double d_size = (std::conj(pole) * shift).real() / size;
      out.log_frequency(k, p) = d_size / size;
      out.damping_ratio(k, p) = -shift.real() / size + pole.real() * d_size / (size * size);
      // ψ' = Σ_j a_j ψ_j with a_j = −(ψ_jᵀ u) / (λ_k − λ_j), a_k from the norm; ψᵀ(C + 2λM)ψ = 1 in state space.
      Eigen::Vector3cd moved_tip = of_input.col(k);
      for (Eigen::Index j = 0; j < 2 * m; ++j) {
        if (j == k) continue;
        moved_tip += tips.col(j) * (-projected(j) / (poles(k) - poles(j)));
      }
      moved_tip += modes.at_tip.col(k) * (-0.5 * self_norm);
      const Eigen::Vector3cd tip = modes.at_tip.col(k);
      const Eigen::Matrix3cd change = moved_tip * tip.transpose() + tip * moved_tip.transpose();
      const double norm = tip.squaredNorm();
      out.residue[static_cast<std::size_t>(k)].col(p) =
          Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(change.data()) / std::max(norm, 1e-300);
    }
  }
  return out;
}

}  // namespace robomill::modal::detail
