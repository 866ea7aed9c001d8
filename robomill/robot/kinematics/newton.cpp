#include "robomill/robot/kinematics/newton.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace robomill::robot {
namespace {

/// What takes `pose` to `wanted`: translation, and rotation as axis times angle, in B.
Position6 pose_error(const Eigen::Isometry3d& wanted, const Eigen::Isometry3d& pose) noexcept {
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(wanted.linear() * pose.linear().transpose()));
  Position6 out;
  out << wanted.translation() - pose.translation(), rotation.angle() * rotation.axis();
  return out;
}

/// pose_error for small errors: the rotation's sine in place of its angle, which is what Newton's steps make of it.
Position6 small_error(const Eigen::Isometry3d& wanted, const Eigen::Isometry3d& pose) noexcept {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    turn += Eigen::Vector3d(pose.linear().col(i)).cross(Eigen::Vector3d(wanted.linear().col(i)));
  }
  Position6 out;
  out << wanted.translation() - pose.translation(), 0.5 * turn;
  return out;
}

}  // namespace

NewtonEnd newton(const Arm& arm, const Eigen::Isometry3d& flange, Eigen::Ref<Eigen::VectorXd> position,
                 const NearOptions& options) noexcept {
  // Of bounded size, so that nothing is allocated.
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, max_joints>;
  using Joints = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, max_joints, 1>;
  NewtonEnd out;
  Posture posture;
  posture.update(arm, position);
  Position6 error = pose_error(flange, posture.flange);
  Jacobian jac(6, arm.size());
  posture.jacobian(arm, posture.flange.translation(), jac);
  // Falls with the square of the error, so that the steps end as Newton's do.
  double damping = std::min(1e-4, error.squaredNorm());
  for (; out.iterations < options.max_iterations; ++out.iterations) {
    if (error.head<3>().norm() <= options.tolerance_m && error.tail<3>().norm() <= options.tolerance_rad) break;
    Eigen::Matrix<double, 6, 6> gram = jac.lazyProduct(jac.transpose());
    gram.diagonal().array() += damping;
    const Position6 pull = gram.ldlt().solve(error);
    Joints trial = position;
    for (Eigen::Index i = 0; i < trial.size(); ++i) trial(i) += jac.col(i).dot(pull);
    posture.update(arm, trial);
    const Position6 left = pose_error(flange, posture.flange);
    if (left.squaredNorm() < error.squaredNorm()) {
      position = trial;
      error = left;
      posture.jacobian(arm, posture.flange.translation(), jac);
      damping = std::clamp(error.squaredNorm(), 1e-18, 0.1 * damping + 1e-18);
    } else {
      damping = std::max(10.0 * damping, 1e-12);
    }
  }
  out.error_m = error.head<3>().norm();
  out.error_rad = error.tail<3>().norm();
  return out;
}

bool newton_nearby(const Arm& arm, const Eigen::Isometry3d& flange, double tolerance, Position6& position,
                   Posture& posture, Eigen::Matrix<double, 6, 6>& jacobian) noexcept {
  double before = 0.1;  // farther away the sine does not serve
  for (int step = 0; step < 8; ++step) {
    posture.update(arm, position);
    posture.jacobian(arm, posture.flange.translation(), jacobian);
    const Position6 error = small_error(flange, posture.flange);
    const double size = error.cwiseAbs().maxCoeff();
    if (size <= tolerance) return true;
    if (!(size <= 0.5 * before)) return false;
    before = size;
    position += jacobian.partialPivLu().solve(error);
  }
  return false;
}

}  // namespace robomill::robot
