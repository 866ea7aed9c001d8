#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/robot/README.md, "Mass and modes"

namespace robomill::robot {

/// Joint-space mass matrix M, n x n, of the links (Orocos KDL) with the drives' rotors on its diagonal.
/// @param position  length n
/// @throws InvalidInput if it has another length or is not finite, or the arm is invalid
[[nodiscard]] ROBOMILL_API Eigen::MatrixXd mass_matrix(const Arm& arm,
                                                       const Eigen::Ref<const Eigen::VectorXd>& position);

/// A vibration of the tool's point, in the scaling of robomill/modal: H = Σ R Lᵀ / (iω − λ) + the conjugate pole's.
struct ToolMode {
  double frequency_hz = 0.0;   ///< |λ| / 2π
  double damping_ratio = 0.0;  ///< −Re λ / |λ|
  Eigen::Matrix<std::complex<double>, 6, 1> right = Eigen::Matrix<std::complex<double>, 6, 1>::Zero();
  Eigen::Matrix<std::complex<double>, 6, 1> left = Eigen::Matrix<std::complex<double>, 6, 1>::Zero();
};
/// A motion that decays without oscillation: H = R Lᵀ / (iω + decay).
struct OverdampedMode {
  double decay_per_s = 0.0;
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> left = Eigen::Matrix<double, 6, 1>::Zero();
};
struct ToolModes {
  std::vector<ToolMode> modes = {};             ///< by frequency
  std::vector<OverdampedMode> overdamped = {};  ///< in pairs, where a joint is damped more than critically
};

/// What of the joint-space mass matrix counts.
enum class Inertia {
  full,
  diagonal  ///< the joints' own, without what couples them: M = J⁻ᵀ I_θ J⁻¹ of [BallEndRobot] with a diagonal I_θ
};

/// Modes of M q̈ + C q̇ + Kθ q = Jᵀ F seen at a point: C the joints' damping, of any kind, by the eigenvalues of the
/// state-space form. H, 6 x 6, is translation (m) and rotation (rad) of the point due to force (N) and moment (N m), in
/// B. Rows 1 to 3 of right and left in sqrt(s/kg), 4 to 6 in rad sqrt(s/kg)/m. H is symmetric and left = right.
/// @param point_m  in the flange frame
/// @throws InvalidInput as stiffness(), or if M is not positive definite (a joint moves no mass)
[[nodiscard]] ROBOMILL_API ToolModes tool_modes(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                                const Eigen::Vector3d& point_m, Inertia inertia = Inertia::full);

}  // namespace robomill::robot
