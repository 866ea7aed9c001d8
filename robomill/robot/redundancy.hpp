#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Stiffness under load"

namespace robomill::robot {

struct ROBOMILL_API RedundancyOptions {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();  ///< of the cut on the robot at the tip, in W; required
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of the surface, in W, unit: ||normal| − 1| <= 1e-6
  int samples = 72;                                   ///< >= 4; over a full turn
  double tolerance_rad = 1e-4;                        ///< > 0; ends where the range that holds gamma is <= this
  SingularityOptions singularity = {};                ///< at the tip
  std::optional<Position6> previous = {};  ///< keeps to the branch nearest to it; else the best of all branches
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A posture with one turn about the tool's axis.
struct RedundancySample {
  double gamma_rad = 0.0;
  Reach::Status status = Reach::Status::out_of_reach;  ///< the numbers below stand where it is `found`
  Position6 position_rad = Position6::Zero();
  bool buckled = false;             ///< the joints cannot hold the force there: what follows says nothing
  double limit_distance_rad = 0.0;  ///< of the joint nearest to its limit
  double condition_number = 0.0;
  Eigen::Matrix<double, 6, 6> compliance = Eigen::Matrix<double, 6, 6>::Zero();  ///< at the tip under the force, in W
  Eigen::Vector3d error_m = Eigen::Vector3d::Zero();  ///< of the tip under the force, C F, in W
  double error_along_normal_m = 0.0;                  ///< its part along the normal
};

struct Redundancy {
  enum class Status {
    found,  ///< one sample at least has a posture: `best` is refined from the best of them
    none    ///< no gamma gives a regular posture within limits that holds the force
  };
  Status status = Status::none;
  std::vector<RedundancySample> samples = {};  ///< gamma from −π, evenly
  RedundancySample best = {};
};

/// What turning the flange about the tool's axis does to a cut: every gamma's posture, stiffness and error, and the
/// best gamma, at which the length of the tip's error |C F| is least, refined between the samples on its branch by
/// golden section.
/// @param tool  its gamma is not used
/// @throws InvalidInput if an option is invalid, the cell is invalid, or a joint has no stiffness
[[nodiscard]] ROBOMILL_API Redundancy redundancy(const Cell& cell, const SphericalWristInverse& inverse,
                                                 const ToolPose& tool, const RedundancyOptions& options);

}  // namespace robomill::robot
