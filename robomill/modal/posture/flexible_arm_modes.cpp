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

/// Modes and their conjugates, and how they move masses.
struct FlexibleArm::Spanned {
  Eigen::Index modes = 0;                        // m
  Eigen::MatrixXcd basis;                        // n x 2m
  std::vector<Eigen::Matrix3Xcd> moved, turned;  // a body's centre, and its turning, 3 x 2m
  std::vector<Eigen::Matrix3Xcd> tool;           // a mass of the tool

  Spanned(const System& system, const Eigen::MatrixXcd& shape) : modes(shape.cols()), basis(shape.rows(), 2 * modes) {
    basis << shape, shape.conjugate();
    const auto spanned = [&](const Eigen::MatrixXd& motion) {
      const Eigen::Matrix3Xcd by_modes = motion * shape;
      Eigen::Matrix3Xcd out(3, 2 * modes);
      out << by_modes, by_modes.conjugate();
      return out;
    };
    for (const BodyMotion& body : system.bodies) {
      moved.push_back(spanned(body.linear));
      turned.push_back(spanned(body.turning));
    }
    for (const ToolMotion& mass : system.tools) tool.push_back(spanned(mass.input.transpose()));
  }
};

Eigen::MatrixXcd FlexibleArm::mass_change(const System& system, const ArmParameter& parameter,
                                          const Spanned& by) const {
  const Eigen::Index m = by.modes;
  const std::size_t index = parameter.index;
  if (parameter.kind == Kind::rotor_inertia) {
    const Eigen::Index c = joint_row(index);
    return system.rotor(c) * (by.basis.row(c).transpose() * by.basis.row(c).head(m));
  }
  if (parameter.kind == Kind::tool_mass) {
    return system.tools[index].mass_kg * (by.tool[index].transpose() * by.tool[index].leftCols(m));
  }
  if (parameter.kind == Kind::bracket_pivot) {
    const Eigen::Matrix3Xcd pivot = pivot_change(system, index, by.basis);
    Eigen::Matrix3Xcd carried = Eigen::Matrix3Xcd::Zero(3, 2 * m);
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
      if (system.bodies[b].on_bracket) carried += system.bodies[b].mass_kg * by.moved[b];
    }
    for (std::size_t t = 0; t < system.tools.size(); ++t) carried += system.tools[t].mass_kg * by.tool[t];
    return carried.transpose() * pivot.leftCols(m) + pivot.transpose() * carried.leftCols(m);
  }
  const BodyMotion& body = system.bodies[index];
  const Eigen::Matrix3Xcd &moved = by.moved[index], &turned = by.turned[index];
  if (parameter.kind == Kind::body_center) {
    // The velocity of a centre that moves out by a unit along an axis of its link.
    const Eigen::Matrix3Xcd swung = -cross_matrix(body.axes.col(static_cast<Eigen::Index>(parameter.axis))) * turned;
    return body.mass_kg * (swung.transpose() * moved.leftCols(m) + moved.transpose() * swung.leftCols(m));
  }
  Eigen::MatrixXcd out = turned.transpose() * (body.inertia * turned.leftCols(m));
  if (parameter.kind == Kind::body_mass) out += body.mass_kg * (moved.transpose() * moved.leftCols(m));
  return out;
}

Eigen::Matrix3cd FlexibleArm::receptance(const System& system, Complex s) {
  const Eigen::MatrixXcd moved =
      linear_algebra::solve(dynamic_stiffness(system, s), Eigen::MatrixXcd(system.input.cast<Complex>()));
  return system.input.transpose() * moved + in_base(system);
}

double total_variance(const Eigen::MatrixXcd& by, const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd parts(2 * by.rows(), by.cols());
  parts << by.real(), by.imag();
  return std::max(0.0, (parts * covariance).cwiseProduct(parts).sum());
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
  const Spanned by(system, modes.shape);
  Eigen::VectorXcd poles(2 * m);
  poles << modes.pole, modes.pole.conjugate();
  Eigen::Matrix3Xcd tips(3, 2 * m);
  tips << modes.at_tip, modes.at_tip.conjugate();
  // ψ' = Σ_j a_j ψ_j with a_j = −(ψ_jᵀ u) / (λ_k − λ_j), a_k from the norm; ψᵀ(C + 2λM)ψ = 1 in state space.
  std::vector<Eigen::Matrix3Xcd> tip_by_projection(static_cast<std::size_t>(m), -tips);
  for (Eigen::Index k = 0; k < m; ++k) {
    Eigen::Matrix3Xcd& to = tip_by_projection[static_cast<std::size_t>(k)];
    for (Eigen::Index j = 0; j < 2 * m; ++j) to.col(j) *= j == k ? Complex(0.0) : 1.0 / (poles(k) - poles(j));
  }
  const Eigen::VectorXcd squared_poles = modes.pole.cwiseProduct(modes.pole);
  for (Eigen::Index p = 0; p < count; ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::compliance) continue;
    const SpringChange& spring = system.springs[static_cast<std::size_t>(p)];
    const bool mass = spring.count == 0;
    // ψ_jᵀ u, u = (∂K + λ ∂C + λ² ∂M) ψ
    Eigen::MatrixXcd projected;
    Eigen::VectorXcd self_norm(m);
    if (mass) {
      projected = mass_change(system, parameter, by);
      self_norm = 2.0 * modes.pole.cwiseProduct(projected.diagonal());
      projected = projected * squared_poles.asDiagonal();
    } else {
      const Eigen::Index r = spring.first, n_rows = spring.count;
      const Eigen::MatrixXcd all = by.basis.middleRows(r, n_rows), own = all.leftCols(m);
      const Eigen::MatrixXcd damped = all.transpose() * (spring.damping.topLeftCorner(n_rows, n_rows) * own);
      projected =
          all.transpose() * (spring.stiffness.topLeftCorner(n_rows, n_rows) * own) + damped * modes.pole.asDiagonal();
      self_norm = damped.diagonal();
    }
    const Eigen::Matrix3Xcd of_input = parameter.kind == Kind::bracket_pivot
                                           ? pivot_change(system, parameter.index, modes.shape)
                                           : Eigen::Matrix3Xcd::Zero(3, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Complex pole = modes.pole(k), shift = -projected(k, k);  // dλ
      const double size = std::abs(pole);
      const double d_size = (std::conj(pole) * shift).real() / size;
      out.log_frequency(k, p) = d_size / size;
      out.damping_ratio(k, p) = -shift.real() / size + pole.real() * d_size / (size * size);
      const Eigen::Vector3cd tip = modes.at_tip.col(k);
      const Eigen::Vector3cd moved_tip = of_input.col(k) +
                                         tip_by_projection[static_cast<std::size_t>(k)] * projected.col(k) -
                                         0.5 * self_norm(k) * tip;
      const Eigen::Matrix3cd change = moved_tip * tip.transpose() + tip * moved_tip.transpose();
      out.residue[static_cast<std::size_t>(k)].col(p) =
          Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(change.data()) / std::max(tip.squaredNorm(), 1e-300);
    }
  }
  return out;
}

}  // namespace robomill::modal::detail
