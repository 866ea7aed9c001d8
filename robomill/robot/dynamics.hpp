#pragma once
#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Mass and modes"

namespace robomill::robot {

/// Joint-space mass matrix M, n x n, of the links (Orocos KDL) with the drives' rotors on its diagonal.
/// @param position  length n
/// @throws InvalidInput if it has another length or is not finite, or the arm is invalid
[[nodiscard]] ROBOMILL_API Eigen::MatrixXd mass_matrix(const Arm& arm,
                                                       const Eigen::Ref<const Eigen::VectorXd>& position);

/// Which part of the mass matrix counts.
enum class Inertia {
  full,     ///< all of M: joints accelerate each other
  diagonal  ///< M without what is off its diagonal, as published for a milling robot: good where one joint moves alone
};

/// What a point of the tool resists to acceleration.
struct CartesianMass {
  enum class Status {
    regular,  ///< condition_number <= options.max_condition_number: Λ stands in `mass`
    singular  ///< above it: the point can hardly move in some direction, Λ has no bound there
  };
  Status status = Status::singular;
  Eigen::Matrix<double, 6, 6> mass = Eigen::Matrix<double, 6, 6>::Zero();  ///< Λ; zero where singular
  double condition_number = 0.0;                                           ///< of the Jacobian
};
/// Λ = (J M⁻¹ Jᵀ)⁻¹ [kg, kg m; kg m, kg m²] in B.
/// @param point_m  in the flange frame
/// @throws InvalidInput if M is not positive definite (a joint moves no mass), or as stiffness()
/// Source: [Khatib1987]
[[nodiscard]] ROBOMILL_API CartesianMass cartesian_mass(const Arm& arm,
                                                        const Eigen::Ref<const Eigen::VectorXd>& position,
                                                        const Eigen::Vector3d& point_m, Inertia inertia = Inertia::full,
                                                        const SingularityOptions& options = {});

struct ROBOMILL_API ToolModesOptions {
  Wrench wrench = {};                        ///< what the robot bears, for Kc
  Inertia inertia = Inertia::full;           ///< of M
  std::optional<double> damping_ratio = {};  ///< in [0, 1): of every mode, in place of the joints' damping
  /// @throws InvalidInput naming the member
  void validate() const;
};

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
  enum class Status {
    found,   ///< every pole stands in `modes` or `overdamped`
    buckled  ///< (Kθ − Kc) is not positive definite: the arm does not hold the wrench, nothing vibrates about it
  };
  Status status = Status::buckled;
  std::vector<ToolMode> modes = {};             ///< by frequency
  std::vector<OverdampedMode> overdamped = {};  ///< in pairs, where a joint is damped more than critically
  /// H at a frequency, 6 x 6: translation (m) and rotation (rad) of the point due to force (N) and moment (N m), in B.
  [[nodiscard]] ROBOMILL_API Eigen::Matrix<std::complex<double>, 6, 6> receptance(double frequency_hz) const;
};

/// Modes of M q̈ + C q̇ + (Kθ − Kc) q = Jᵀ F seen at a point: C the joints' damping, of any kind, by the eigenvalues of
/// the state-space form. Rows 1 to 3 of right and left in sqrt(s/kg), 4 to 6 in rad sqrt(s/kg)/m. Without moments H is
/// symmetric and left = right. buckled: (Kθ − Kc) is not positive definite.
/// @throws InvalidInput as stiffness() and cartesian_mass()
[[nodiscard]] ROBOMILL_API ToolModes tool_modes(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                                const Eigen::Vector3d& point_m, const ToolModesOptions& options = {});

}  // namespace robomill::robot
