#include "robomill/robot/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/robot/kinematics/kdl_chain.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::robot {
namespace {

using Complex = std::complex<double>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// L of M = L Lᵀ.
Eigen::MatrixXd mass_factor(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, Inertia inertia) {
  Eigen::MatrixXd mass = mass_matrix(arm, position);
  if (inertia == Inertia::diagonal) mass = Eigen::MatrixXd(mass.diagonal().asDiagonal());
  for (Eigen::Index i = 0; i < arm.size(); ++i) {
    if (mass(i, i) > 0.0) continue;
    throw InvalidInput("joints[" + std::to_string(i + 1) + "].link.mass_kg", 0.0, "kg",
                       "must be > 0: the joint moves no mass",
                       "Links' masses, centres and inertia, or the drives' rotor inertia, are needed");
  }
  linear_algebra::Cholesky out = linear_algebra::cholesky(mass);
  if (!out.positive_definite) {
    throw InvalidInput("joints", "must move masses that make the mass matrix positive definite",
                       "The wrist's links need an inertia, or its drives a rotor inertia");
  }
  return out.lower;
}

/// right and left of one pole scaled to one size, and to be equal where they are parallel.
template <class Scalar>
void balance(Eigen::Matrix<Scalar, 6, 1>& right, Eigen::Matrix<Scalar, 6, 1>& left, const Scalar& ratio) {
  const Scalar scale = std::sqrt(ratio);
  right *= scale;
  left /= scale;
}

/// σ² y + σ damping y + stiffness y = Pᵀ F / rate², with σ = s / rate.
struct Normal {
  Eigen::MatrixXd stiffness, damping;
  Eigen::MatrixXd input;  // n x 6, P
  double rate_per_s = 1.0;
};

/// The pole's vectors: x on top of its eigenvector, y at the bottom of its row of the inverse.
ToolMode make_mode(const Normal& system, const Complex& pole, const Eigen::VectorXcd& x, const Eigen::VectorXcd& y) {
  ToolMode mode;
  const double size = std::abs(pole);
  mode.frequency_hz = size * system.rate_per_s / (2.0 * std::numbers::pi);
  mode.damping_ratio = -pole.real() / size;
  const double root = std::sqrt(system.rate_per_s);
  mode.right = system.input.transpose() * x / root;
  mode.left = system.input.transpose() * y / root;
  // y = β x for symmetric systems, and β in size for others.
  const Complex beta = x.dot(y) / x.squaredNorm();
  const double wanted = y.norm() / x.norm();
  const double unit = std::abs(beta);
  balance(mode.right, mode.left, unit > 0.0 ? Complex(beta * (wanted / unit)) : Complex(wanted));
  return mode;
}

OverdampedMode make_overdamped(const Normal& system, double pole, const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  OverdampedMode mode{.decay_per_s = -pole * system.rate_per_s};
  const double root = std::sqrt(system.rate_per_s);
  mode.right = system.input.transpose() * x / root;
  mode.left = system.input.transpose() * y / root;
  balance(mode.right, mode.left, y.norm() / x.norm());
  return mode;
}

void solve_modes(const Normal& system, ToolModes& out) {
  const Eigen::Index n = system.stiffness.rows();
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  state.topRightCorner(n, n).setIdentity();
  state.bottomLeftCorner(n, n) = -system.stiffness;
  state.bottomRightCorner(n, n) = -system.damping;
  const linear_algebra::EigenPairs pairs = linear_algebra::eigen_pairs(state);
  if (!pairs.converged) {
    throw InvalidInput("joints", "have no modes that double precision can find", "Are the units mixed?");
  }
  const Eigen::MatrixXcd& vectors = pairs.vectors;
  const Eigen::MatrixXcd back = linear_algebra::inverse(vectors);
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    const Complex pole = pairs.values(k);
    const Eigen::VectorXcd x = vectors.col(k).head(n), y = back.row(k).tail(n).transpose();
    if (pole.imag() > 0.0) {
      out.modes.push_back(make_mode(system, pole, x, y));
    } else if (pole.imag() == 0.0) {
      out.overdamped.push_back(make_overdamped(system, pole.real(), x.real(), y.real()));
    }
  }
  std::sort(out.modes.begin(), out.modes.end(),
            [](const ToolMode& a, const ToolMode& b) { return a.frequency_hz < b.frequency_hz; });
}

}  // namespace

Eigen::MatrixXd mass_matrix(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position) {
  arm.validate();
  (void)forward(arm, position);  // rejects a position of another length
  const auto n = static_cast<unsigned>(arm.size());
  KDL::JntArray at(n);
  at.data = position;
  KDL::JntSpaceInertiaMatrix mass(static_cast<int>(n));
  KDL::ChainDynParam(kdl_chain(arm), KDL::Vector::Zero()).JntToMass(at, mass);
  Eigen::MatrixXd out = mass.data;
  for (Eigen::Index i = 0; i < arm.size(); ++i) out(i, i) += arm.joints[static_cast<std::size_t>(i)].rotor_inertia;
  return out;
}

ToolModes tool_modes(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, const Eigen::Vector3d& point_m,
                     Inertia inertia) {
  static_cast<void>(stiffness(arm, position, point_m));  // checks what is given
  const Eigen::MatrixXd factor = mass_factor(arm, position, inertia);
  const Jacobian jac = jacobian(arm, position, point_m);
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(arm.size(), arm.size()), damping = joint;
  for (Eigen::Index i = 0; i < arm.size(); ++i) {
    joint(i, i) = arm.joints[static_cast<std::size_t>(i)].stiffness;
    damping(i, i) = arm.joints[static_cast<std::size_t>(i)].damping;
  }
  // In y = Lᵀ q with M = L Lᵀ.
  const auto lower = factor.triangularView<Eigen::Lower>();
  const auto normal = [&](const Eigen::MatrixXd& matrix) {
    const Eigen::MatrixXd half = lower.solve(matrix);
    return Eigen::MatrixXd(lower.solve(half.transpose()).transpose());
  };
  Normal system{
      .stiffness = normal(joint), .damping = normal(damping), .input = lower.solve(Eigen::MatrixXd(jac.transpose()))};
  system.rate_per_s = std::sqrt(system.stiffness.trace() / static_cast<double>(arm.size()));
  system.stiffness /= system.rate_per_s * system.rate_per_s;
  system.damping /= system.rate_per_s;
  ToolModes out;
  solve_modes(system, out);
  return out;
}

}  // namespace robomill::robot
