#pragma once
// The Jacobian's derivative, by which tests find the stiffness under load another way.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace robomill::robot::testing {

/// ∂J/∂q_k, 6 x n, of a Jacobian J with columns (v_i, w_i), from the screws alone: with a = min(i, k), b = max(i, k)
///     ∂v_i/∂q_k = w_a × v_b,    ∂w_i/∂q_k = w_k × w_i for k < i, else 0
/// (w = 0 for a prismatic joint).
/// @param joint  k, from 0
inline Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_derivative(
    const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& jacobian, Eigen::Index joint) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> out(6, jacobian.cols());
  const Eigen::Vector3d turn = jacobian.col(joint).tail<3>(), move = jacobian.col(joint).head<3>();
  for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
    const Eigen::Vector3d own_turn = jacobian.col(i).tail<3>(), own_move = jacobian.col(i).head<3>();
    if (joint < i) {
      out.col(i) << turn.cross(own_move), turn.cross(own_turn);
    } else {
      out.col(i) << own_turn.cross(move), Eigen::Vector3d::Zero();
    }
  }
  return out;
}

}  // namespace robomill::robot::testing
