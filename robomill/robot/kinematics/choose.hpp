#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::robot {

struct ChooseOptions {
  SingularityOptions singularity = {};                ///< of the Jacobian at `point_m`
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< in the flange frame: the tool's tip
  Position6 weight = Position6::Ones();               ///< >= 0; of each joint's travel [1/rad]
  double max_travel_rad = HUGE_VAL;                   ///< > 0; jump where max |q - previous| > this
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// One position for a pose.
struct Choice {
  Reach::Status status = Reach::Status::out_of_reach;
  Position6 position_rad = Position6::Zero();           ///< zero where out of reach
  double travel_rad = 0.0;                              ///< the largest of a joint from the previous position
  double condition_number = 0.0;                        ///< within limits: of the Jacobian at the point
  double out_of_reach_m = 0.0, out_of_reach_rad = 0.0;  ///< InverseSolutions'
  Eigen::Index joint = -1;  ///< outside limits: the one that is farthest beyond its limit, from 0
  double beyond_rad = 0.0;  ///< … and by how much, in the solution where that is least
};

/// Of all solutions and the turns by ±2π of each joint that lie within the joint limits, the one nearest to the
/// previous position: the least Σ (weight (q − previous))². Allocates nothing; options and arm are not checked.
/// @param arm  the one that the solutions are of; six joints
[[nodiscard]] Choice choose(const Arm& arm, const InverseSolutions& solutions, const Position6& previous,
                            const ChooseOptions& options = {}) noexcept;

/// A way through poses.
struct Followed {
  Reach::Status status = Reach::Status::found;  ///< of the first pose that has no regular position within limits
  std::size_t reached = 0;                      ///< poses before that one: all of them where found
  std::vector<Position6> position_rad = {};     ///< one each pose reached
  Choice last = {};                             ///< of the pose where it ended
  double largest_travel_rad = 0.0;              ///< the largest step of a joint
};

/// Goes through the poses by choose(), from one to the next. Without a start it tries every way to stand at the first
/// pose and takes the one that gets farthest; of those the one with the least largest step.
/// @param flanges  in B
/// @param start    position before the first pose
/// @throws InvalidInput if an option is invalid, there is no pose, or the arm has not six joints
[[nodiscard]] Followed follow(const Arm& arm, const SphericalWristInverse& inverse,
                              const std::vector<Eigen::Isometry3d>& flanges, const std::optional<Position6>& start = {},
                              const ChooseOptions& options = {});

struct NearOptions {
  double tolerance_m = 1e-12;    ///< > 0; converged where error_m <= this …
  double tolerance_rad = 1e-12;  ///< > 0; … and error_rad <= this
  int max_iterations = 100;      ///< >= 1; steps, those that were taken back among them
  /// @throws InvalidInput naming the member
  void validate() const;
};
struct NearResult {
  enum class Status {
    converged,     ///< both errors are within their tolerances
    not_converged  ///< max_iterations steps were not enough: no position near the seed, or a singular one
  };
  Status status = Status::not_converged;
  Eigen::VectorXd position = {};          ///< the best one found, also where not converged
  double error_m = 0.0, error_rad = 0.0;  ///< residual of the flange's position and orientation
};
/// The position at which an arm of any kind reaches a pose, by damped Newton steps (Levenberg-Marquardt) from a seed
/// near it. Limits are not looked at.
/// @param flange  in B
/// @param seed    length n
/// @throws InvalidInput if an option is invalid, the seed has another length, or a number is not finite
[[nodiscard]] NearResult solve_near(const Arm& arm, const Eigen::Isometry3d& flange,
                                    const Eigen::Ref<const Eigen::VectorXd>& seed, const NearOptions& options = {});

}  // namespace robomill::robot
