#pragma once
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Identification"

namespace robomill::robot {

/// A known load on the tool and how far the point went.
struct Load {
  Eigen::VectorXd position = {};                             ///< of the joints without the load, length n [rad or m]
  Wrench wrench = {};                                        ///< on the robot at the point, in B
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();  ///< measured, of the point, in B
  double deviation_m = 0.0;  ///< standard deviation of each of its numbers, for weights; 0 in all loads: all alike
};

struct ROBOMILL_API IdentifyOptions {
  /// > 0; a joint is identifiable where compliance_deviation <= this · compliance.
  double max_relative_deviation = 0.5;
  /// > 0; ends where max |Δc| <= tolerance · max |c|, or where rounding stops it: that ratio is < 1e-7 and >= half the
  /// one before.
  double tolerance = 1e-12;
  int max_iterations = 50;  ///< >= 1; of each fit: one, and one more for each joint that is taken as rigid
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// What loads say of one joint.
struct IdentifiedJoint {
  double compliance = 0.0;  ///< 1/k [rad/(N m) or m/N]
  double compliance_deviation = std::numeric_limits<double>::infinity();
  double stiffness = 0.0;                                      ///< k [N m/rad or N/m]; 0 where not identifiable
  double deviation = std::numeric_limits<double>::infinity();  ///< of k; infinite where not identifiable
  bool identifiable = false;
  std::string reason = {};  ///< why not, a sentence
};

struct IdentifiedStiffness {
  enum class Status {
    converged,     ///< the compliances no longer change; `joints` says which of them are identifiable
    not_converged  ///< max_iterations were not enough, or a compliance was not finite; no joint is identifiable
  };
  Status status = Status::not_converged;
  std::vector<IdentifiedJoint> joints = {};
  Eigen::Matrix3Xd residual_m = {};  ///< 3 x loads, measured less model, in B
  double rms_m = 0.0;                ///< of the residuals' numbers, each weighted by the mean variance over its own
  double r_squared = 0.0;            ///< 1 − Σ (residual/deviation)² / Σ (displacement/deviation)²
  double condition_number = 0.0;     ///< of the least squares, columns scaled to one length, without unseen joints
  int iterations = 0;
};

/// Joint stiffness from loads and measured displacements by least squares.
///
/// The model is the loaded equilibrium θ = θ0 + c ∘ Jᵀ(θ) F with the compliances c = 1/k; the displacement is linear in
/// c but for the arm's own motion, so that the first Gauss-Newton step is the linear least squares d = J diag(Jᵀ F) c,
/// and the next ones put in what Kc does. Deviations are those of the residuals (of `deviation_m` only the ratios
/// count). Joints that no load turns, or whose turning does not move the point, are found by their column; joints that
/// the data cannot distinguish by a singular value below 1e-9 of the largest. A joint whose compliance comes out
/// as c <= 0 is taken as rigid and reported.
/// @param point_m  in the flange frame
/// @throws InvalidInput naming the load if lengths differ, a number is not finite, some deviations are given and others
///     not, or there are fewer numbers than joints
[[nodiscard]] ROBOMILL_API IdentifiedStiffness identify_joint_stiffness(const Arm& arm, const Eigen::Vector3d& point_m,
                                                                        const std::vector<Load>& loads,
                                                                        const IdentifyOptions& options = {});

}  // namespace robomill::robot
