#include "robomill/robot/stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/robot/condition.hpp"

namespace robomill::robot {
namespace {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

Eigen::Matrix<double, 6, 1> stacked(const Wrench& wrench) {
  Eigen::Matrix<double, 6, 1> out;
  out << wrench.force_n, wrench.moment_n_m;
  return out;
}

void require_input(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, const Eigen::Vector3d& point_m,
                   const Wrench& wrench) {
  if (position.size() != arm.size()) {
    throw InvalidInput("position", static_cast<double>(position.size()), "joints",
                       "must have one value a joint, " + std::to_string(arm.size()));
  }
  if (!position.allFinite()) throw InvalidInput("position", "must be finite");
  if (!point_m.allFinite()) throw InvalidInput("point_m", "must be finite");
  if (!wrench.force_n.allFinite()) throw InvalidInput("wrench.force_n", "must be finite");
  if (!wrench.moment_n_m.allFinite()) throw InvalidInput("wrench.moment_n_m", "must be finite");
}

Eigen::VectorXd joint_stiffness(const Arm& arm) {
  Eigen::VectorXd out(arm.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const Joint& joint = arm.joints[i];
    require_positive(("joints[" + std::to_string(i + 1) + "].stiffness").c_str(), joint.stiffness,
                     joint.prismatic ? "N/m" : "N m/rad",
                     "Every joint's stiffness is needed; loads measured at the tool give it");
    out(static_cast<Eigen::Index>(i)) = joint.stiffness;
  }
  return out;
}

bool positive_definite(const Eigen::MatrixXd& matrix) {
  const Eigen::MatrixXd symmetric = 0.5 * (matrix + matrix.transpose());
  return linear_algebra::cholesky(symmetric).positive_definite;
}

/// An arm on its way to equilibrium.
struct Balance {
  const Arm& arm;
  const Eigen::VectorXd stiffness;
  const Eigen::VectorXd unloaded;
  const Eigen::Vector3d point_m;
  const LoadedOptions& options;
  Posture posture = {};
  Jacobian jacobian = {};
  int iterations = 0;

  /// Kθ (θ − θ0) − Jᵀ(θ) F, in units in which each joint has the stiffness 1.
  Eigen::VectorXd residual(const Eigen::VectorXd& position, const Wrench& wrench) {
    posture.update(arm, position);
    jacobian.resize(6, arm.size());
    posture.jacobian(arm, posture.flange * point_m, jacobian);
    const Eigen::VectorXd torque = jacobian.transpose() * stacked(wrench);
    return (position - unloaded) - torque.cwiseQuotient(stiffness);
  }

  /// Newton from `position`; false where it does not come to a stable equilibrium.
  bool find_equilibrium(Eigen::VectorXd& position, const Wrench& wrench) {
    Eigen::VectorXd residual_now = residual(position, wrench);
    for (int k = 0; k < options.max_iterations; ++k) {
      ++iterations;
      Eigen::MatrixXd matrix = -load_stiffness(jacobian, wrench);
      matrix.diagonal() += stiffness;
      if (!positive_definite(matrix)) return false;
      const Eigen::VectorXd step =
          -linear_algebra::solve(matrix, Eigen::VectorXd(stiffness.cwiseProduct(residual_now)));
      position += step;
      const Eigen::VectorXd residual_next = residual(position, wrench);
      if (!residual_next.allFinite()) return false;
      if (step.cwiseAbs().maxCoeff() <= options.tolerance) return true;
      // Rounding stands in the way of shorter steps.
      if (residual_next.norm() >= residual_now.norm()) return step.norm() <= 1e-9;
      residual_now = residual_next;
    }
    return false;
  }
};

}  // namespace

void SingularityOptions::validate() const {
  require_positive("characteristic_length_m", characteristic_length_m, "m");
  if (!(max_condition_number >= 1.0))
    throw InvalidInput("max_condition_number", max_condition_number, "", "must be >= 1");
}

void LoadedOptions::validate() const {
  require_positive("tolerance", tolerance, "");
  if (max_iterations < 1) throw InvalidInput("max_iterations", max_iterations, "", "must be >= 1");
}

double condition_of(const Eigen::Matrix<double, 6, 6>& jacobian, double characteristic_length_m) noexcept {
  Eigen::Matrix<double, 6, 6> scaled = jacobian;
  scaled.topRows<3>() /= characteristic_length_m;
  const Eigen::JacobiSVD<Eigen::Matrix<double, 6, 6>> svd(scaled);
  const double most = svd.singularValues()(0), least = svd.singularValues()(5);
  return least > 0.0 ? most / least : std::numeric_limits<double>::infinity();
}

double condition_number(const Eigen::Ref<const Jacobian>& jacobian, double characteristic_length_m) {
  require_positive("characteristic_length_m", characteristic_length_m, "m");
  if (!jacobian.allFinite()) throw InvalidInput("jacobian", "must be finite");
  if (jacobian.cols() < 6) return std::numeric_limits<double>::infinity();
  if (jacobian.cols() == 6) return condition_of(jacobian, characteristic_length_m);
  // A wide matrix has the singular values of the triangle of its transpose.
  Eigen::MatrixXd tall = jacobian.transpose();
  tall.leftCols<3>() /= characteristic_length_m;
  return condition_of(linear_algebra::qr_triangle(tall), 1.0);
}

Eigen::MatrixXd load_stiffness(const Eigen::Ref<const Jacobian>& jacobian, const Wrench& wrench) {
  const Eigen::Index n = jacobian.cols();
  Eigen::MatrixXd out(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Vector3d move_k = jacobian.col(k).head<3>(), turn_k = jacobian.col(k).tail<3>();
    // a · (w × v) = v · (a × w)
    const Eigen::Vector3d force_k = wrench.force_n.cross(turn_k), moment_k = wrench.moment_n_m.cross(turn_k);
    out(k, k) = force_k.dot(move_k);
    for (Eigen::Index i = k + 1; i < n; ++i) {
      const double from_force = force_k.dot(jacobian.col(i).head<3>());
      out(k, i) = from_force;
      out(i, k) = from_force + moment_k.dot(jacobian.col(i).tail<3>());
    }
  }
  return out;
}

Stiffness stiffness(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, const Eigen::Vector3d& point_m,
                    const Wrench& wrench, const SingularityOptions& options) {
  options.validate();
  require_input(arm, position, point_m, wrench);
  const Jacobian jac = jacobian(arm, position, point_m);
  Eigen::MatrixXd joint = -load_stiffness(jac, wrench);
  joint.diagonal() += joint_stiffness(arm);
  Stiffness out;
  out.condition_number = condition_number(jac, options.characteristic_length_m);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(joint);
  out.compliance = jac * lu.solve(jac.transpose());
  if (!positive_definite(joint)) {
    out.status = Stiffness::Status::buckled;
  } else if (out.condition_number > options.max_condition_number) {
    out.status = Stiffness::Status::singular;
  } else {
    out.stiffness = out.compliance.partialPivLu().inverse();
  }
  return out;
}

PrincipalStiffness principal_stiffness(const Eigen::Matrix<double, 6, 6>& compliance) {
  const Eigen::Matrix3d block = compliance.topLeftCorner<3, 3>();
  const Eigen::Matrix3d symmetric = 0.5 * (block + block.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  PrincipalStiffness out;
  for (int i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()(2 - i);  // the softest first
    out.stiffness_n_per_m(i) = value > 0.0 ? 1.0 / value : 0.0;
    out.direction.col(i) = solver.eigenvectors().col(2 - i);
  }
  return out;
}

LoadedPosture loaded_posture(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& unloaded,
                             const Eigen::Vector3d& point_m, const Wrench& wrench, const LoadedOptions& options) {
  options.validate();
  require_input(arm, unloaded, point_m, wrench);
  Balance balance{
      .arm = arm, .stiffness = joint_stiffness(arm), .unloaded = unloaded, .point_m = point_m, .options = options};
  LoadedPosture out;
  constexpr double least_part = 1e-3;
  double done = 0.0, part = 1.0;
  out.position = unloaded;
  while (done < 1.0 && part >= least_part) {
    const double share = std::min(1.0, done + part);
    Eigen::VectorXd trial = out.position;
    if (balance.find_equilibrium(trial, {.force_n = share * wrench.force_n, .moment_n_m = share * wrench.moment_n_m})) {
      out.position = trial;
      done = share;
    } else {
      part *= 0.5;
    }
  }
  out.status = done >= 1.0 ? LoadedPosture::Status::converged : LoadedPosture::Status::buckled;
  out.iterations = balance.iterations;
  const Eigen::Isometry3d before = forward(arm, unloaded);
  out.flange = forward(arm, out.position);
  out.displacement_m = out.flange * point_m - before * point_m;
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(out.flange.linear() * before.linear().transpose()));
  out.rotation_rad = turn.angle() * turn.axis();
  return out;
}

}  // namespace robomill::robot
