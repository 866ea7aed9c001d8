#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/robot/README.md, "Stiffness under load"

namespace robomill::robot {

/// Force and moment ON THE ROBOT at a point, in B.
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_n_m = Eigen::Vector3d::Zero();
};

/// When an arm counts as singular.
struct ROBOMILL_API SingularityOptions {
  double characteristic_length_m = 1.0;  ///< > 0; the Jacobian's three rows of velocity are divided by it
  double max_condition_number = 1e3;     ///< >= 1; singular where condition_number() > this
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Largest over smallest singular value of a Jacobian whose first three rows are divided by `characteristic_length_m`;
/// infinite where the arm cannot move the point in all six directions.
/// @param jacobian  6 x n
[[nodiscard]] ROBOMILL_API double condition_number(
    const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& jacobian, double characteristic_length_m = 1.0);

/// Kc = (∂Jᵀ/∂θ) F, n x n: column k is (∂J/∂q_k)ᵀ F, the change of the joint torques Jᵀ F when the arm moves under a
/// wrench that stays as it is. Symmetric for a force; a moment that keeps its direction does work that depends on the
/// way, and makes it unsymmetric.
/// @param jacobian  6 x n, in B at the point where the wrench attacks
[[nodiscard]] ROBOMILL_API Eigen::MatrixXd load_stiffness(
    const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& jacobian, const Wrench& wrench);

/// How an arm deflects at a point of its tool.
struct Stiffness {
  enum class Status {
    regular,   ///< compliance and stiffness hold
    singular,  ///< condition_number > max_condition_number: the compliance holds, `stiffness` is left zero
    buckled    ///< the joints cannot hold the wrench in this posture: (Kθ − Kc) is not positive definite
  };
  Status status = Status::regular;
  /// C, translation (m) and rotation (rad) of the point due to force (N) and moment (N m), in B.
  Eigen::Matrix<double, 6, 6> compliance = Eigen::Matrix<double, 6, 6>::Zero();
  /// C⁻¹; zero unless regular.
  Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
  double condition_number = 0.0;  ///< of the Jacobian; condition_number()
};

/// Compliance of the joints seen at a point, C = J (Kθ − Kc)⁻¹ Jᵀ, so that K = J⁻ᵀ (Kθ − Kc) J⁻¹ where J can be
/// inverted; Kθ the joints' stiffness, Kc = load_stiffness of the wrench that the robot bears there already. Links are
/// rigid. The position is that of the loaded arm (loaded_posture).
/// @param position  length n
/// @param point_m   in the flange frame
/// @throws InvalidInput if a joint has no stiffness ("joints[2].stiffness") or a number is not finite
/// Source: [Salisbury1980] without Kc, [ChenKao2000] with it; robomill/robot/README.md derives the sign.
[[nodiscard]] ROBOMILL_API Stiffness stiffness(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                               const Eigen::Vector3d& point_m, const Wrench& wrench = {},
                                               const SingularityOptions& options = {});

/// Stiffness of a point that is free to turn.
struct PrincipalStiffness {
  Eigen::Vector3d stiffness_n_per_m = Eigen::Vector3d::Zero();  ///< rising; zero where it is undefined
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();      ///< a column each, in B
};
/// Of the inverse of the translational block of C, its symmetric part.
[[nodiscard]] ROBOMILL_API PrincipalStiffness principal_stiffness(const Eigen::Matrix<double, 6, 6>& compliance);

struct ROBOMILL_API LoadedOptions {
  /// > 0; converged where max |Δθ| <= tolerance [rad or m], or where the residual no longer falls and |Δθ| <=
  /// 1e-9.
  double tolerance = 1e-13;
  int max_iterations = 50;  ///< >= 1; for each part of the load
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Where an arm comes to rest under a wrench.
struct LoadedPosture {
  enum class Status {
    converged,  ///< at rest under the whole wrench, (Kθ − Kc) positive definite at every step
    buckled     ///< no stable equilibrium was found on the way from no load to this one, in parts >= 1e-3 of it
  };
  Status status = Status::buckled;
  Eigen::VectorXd position = {};                             ///< θ
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();  ///< in B
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();  ///< of the point, in B
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();    ///< of the flange, axis times angle in B
  int iterations = 0;
};

/// Solves Kθ (θ − θ0) = Jᵀ(θ) F by Newton's method, with (Kθ − Kc) as its matrix; the wrench keeps its direction in B
/// and attacks at a point that moves with the flange. Where a step does not help, the load is put on in parts.
/// @param unloaded  θ0, length n
/// @param point_m   in the flange frame
/// @throws InvalidInput if a joint has no stiffness or a number is not finite
[[nodiscard]] ROBOMILL_API LoadedPosture loaded_posture(const Arm& arm,
                                                        const Eigen::Ref<const Eigen::VectorXd>& unloaded,
                                                        const Eigen::Vector3d& point_m, const Wrench& wrench,
                                                        const LoadedOptions& options = {});

}  // namespace robomill::robot
