#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/kinematics/choose.hpp"

namespace robomill::robot {

struct NewtonEnd {
  double error_m = 0.0, error_rad = 0.0;  ///< residual
  int iterations = 0;
};
/// Moves a position to where the flange takes a pose, by damped Newton steps (Levenberg-Marquardt). Allocates nothing,
/// checks nothing.
/// @param flange    in B
/// @param position  length n; from where to where
NewtonEnd newton(const Arm& arm, const Eigen::Isometry3d& flange, Eigen::Ref<Eigen::VectorXd> position,
                 const NearOptions& options) noexcept;

/// The same for six joints that stand near the solution already, by plain Newton steps; false where they do not bring
/// the error down quickly, and `position` is of no use then.
/// @param posture, jacobian  at the position reached, the Jacobian in B at the flange's origin
bool newton_nearby(const Arm& arm, const Eigen::Isometry3d& flange, double tolerance, Position6& position,
                   Posture& posture, Eigen::Matrix<double, 6, 6>& jacobian) noexcept;

}  // namespace robomill::robot
