#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

/// Base frame B of the robot, flange frame E; docs/frames.md. Joint quantities are rad or m, by joint.
// Method: robomill/robot/README.md, "Jacobian and its derivative"
namespace robomill::robot {

/// A rigid body that moves with a joint, in the frame after that joint (Arm::Joint).
struct Link {
  double mass_kg = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre of mass
};

/// Turns about (or runs along) `axis` of the frame that `before` leads to from the frame after the joint below.
struct Joint {
  std::string name = {};
  bool prismatic = false;
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double min_position = -1e300, max_position = 1e300;                 ///< min < max; within: min <= q <= max [rad or m]
  double max_velocity = 0.0, max_acceleration = 0.0, max_jerk = 0.0;  ///< > 0; 0: not given
  double stiffness = 0.0;                                             ///< Kθ [N m/rad or N/m]; 0: not given
  double damping = 0.0;                                               ///< [N m s/rad or N s/m]
  double rotor_inertia = 0.0;                                         ///< of the drive, at the joint [kg m² or kg]
  double max_torque = 0.0;                                            ///< of the drive [N m or N]; 0: no limit
  Link link = {};                                                     ///< what it moves
};

/// A serial arm.
struct ROBOMILL_API Arm {
  std::vector<Joint> joints = {};
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();  ///< from the frame after the last joint
  /// @throws InvalidInput naming the member ("joints[2].axis", counted from 1)
  void validate() const;
  /// Number of joints, n.
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(joints.size()); }
};

/// Standard Denavit-Hartenberg row: Rz(θ + theta_offset) Tz(d) Tx(a) Rx(α).
struct DhRow {
  double a_m = 0.0, alpha_rad = 0.0, d_m = 0.0, theta_offset_rad = 0.0;
};
/// Tz(d) Tx(a) Rx(α): from the frame after the row's joint to the row's end, the DH frame of its link.
[[nodiscard]] ROBOMILL_API Eigen::Isometry3d dh_link(const DhRow& row);
/// @param base  where the first row begins, in B
/// @throws InvalidInput if there is no row or a number is not finite
[[nodiscard]] ROBOMILL_API Arm arm_from_dh(const std::vector<DhRow>& rows,
                                           const Eigen::Isometry3d& base = Eigen::Isometry3d::Identity());

/// Pose of the flange in B.
/// @param position  length n
/// @throws InvalidInput if it has another length or is not finite
[[nodiscard]] ROBOMILL_API Eigen::Isometry3d forward(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position);

/// 6 x n geometric Jacobian in B of a point that moves with the flange: velocity of the point (3 rows), angular
/// velocity (3 rows).
/// @param point_m  in the flange frame, the tool's tip say
[[nodiscard]] ROBOMILL_API Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(
    const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, const Eigen::Vector3d& point_m);

/// The most joints that an arm may have: 1 <= n <= max_joints.
inline constexpr int max_joints = 16;

/// Where the axes of an arm stand at one position: forward kinematics and Jacobian together, without allocation.
struct ROBOMILL_API Posture {
  using Axes = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, max_joints>;
  Axes axis = {};      ///< 3 x n, of each joint in B
  Axes origin_m = {};  ///< 3 x n, of each joint's frame in B
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
  /// @param arm       of at most max_joints joints
  /// @param position  length n, finite; neither is checked
  void update(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position);
  /// The Jacobian of jacobian().
  /// @param at_m  the point in B, flange * point_m
  /// @param out   6 x n
  void jacobian(const Arm& arm, const Eigen::Vector3d& at_m,
                Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const;
};

/// How far a position is from the limits of its joints.
struct LimitCheck {
  bool inside = true;       ///< min_position <= q <= max_position for every joint
  Eigen::Index joint = -1;  ///< the one nearest to its limit, or farthest beyond it, by its share of the joint's half
                            ///< range (half a turn at most); from 0; -1 where no joint has limits
  double distance = 1e300;  ///< of that joint to its nearer limit, < 0 beyond [rad or m]
};
/// @param position  length n
/// @throws InvalidInput if it has another length
[[nodiscard]] ROBOMILL_API LimitCheck within_limits(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position);

/// A robot with a tool before a workpiece.
struct ROBOMILL_API Cell {
  Arm arm;
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();  ///< work frame W in B
  double tool_length_m = 0.0;  ///< from the flange to the tip along the flange's z, >= 0; the tool's axis is -z of the
                               ///< flange, from the tip to the spindle
  /// @throws InvalidInput naming the member
  void validate() const;
};

}  // namespace robomill::robot
