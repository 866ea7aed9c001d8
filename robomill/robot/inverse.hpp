#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/robot/README.md, "Inverse kinematics in closed form"

namespace robomill::robot {

using Position6 = Eigen::Matrix<double, 6, 1>;

/// One way of an arm to reach a pose.
struct InverseSolution {
  Position6 position_rad = Position6::Zero();  ///< each in (-π, π]; limits are not looked at
  bool shoulder_back = false;                  ///< the second of the two angles of joint 1
  bool elbow_down = false;                     ///< the second of the two angles of joint 3
  bool wrist_flipped = false;                  ///< the second of the two angles of joint 5
  double elbow_rad = 0.0;                      ///< >= 0; of joint 3 from where the arm is stretched or folded
  double wrist_rad = 0.0;  ///< >= 0; of joint 5 from where axes 4, 5 and 6 lie in one plane: 4 and 6 in one line
                           ///< where they are perpendicular to 5
};

/// All ways of an arm to reach a pose.
struct InverseSolutions {
  enum class Status {
    found,        ///< one solution at least
    out_of_reach  ///< none: out_of_reach_m and out_of_reach_rad say by how much
  };
  Status status = Status::out_of_reach;
  int count = 0;  ///< of `solution` that hold
  std::array<InverseSolution, 8> solution = {};
  double shoulder_m = 0.0;        ///< of the wrist's centre from axis 1, or from the cylinder around it that a sideways
                                  ///< offset keeps it out of: 0 where joint 1 is singular
  double out_of_reach_m = 0.0;    ///< the least by which the wrist's centre is too far from the arm or too near
  double out_of_reach_rad = 0.0;  ///< the least by which a wrist whose axes are not perpendicular must bend further
  bool shoulder_singular = false;  ///< the centre lies on axis 1 (< 1e-12 m): joint 1 is free and stands where the
                                   ///< hint says
  bool wrist_singular = false;     ///< in some solution joints 4 and 6 turn about one line (sine between them < 1e-12):
                                   ///< joint 4 is free and stands where the hint says
};

/// Closed-form inverse kinematics of arms with six revolute joints and a spherical wrist.
///
/// Asked of the arm: axes 2 and 3 parallel and apart; axis 1 not parallel to them; axes 4, 5 and 6 meeting in a point
/// that is not on axis 3; axis 5 parallel to neither 4 nor 6. Offsets in any direction, any angle between the other
/// axes, any base and flange transforms are allowed.
///
/// From the pose follow the wrist's centre and axis 6. Joint 1 turns the centre to its fixed distance along axis 2,
/// joint 3 makes its distance from axis 2, joint 2 its direction, joint 5 the angle between axes 4 and 6, joints 4 and
/// 6 what remains; robomill/robot/README.md has the equations. Poses that rounding alone (1e-10 of the sizes squared)
/// puts out of reach are taken as reached. Source: [Pieper1968].
class ROBOMILL_API SphericalWristInverse {
 public:
  /// @param tolerance  > 0; by how much axes may miss being parallel [rad] or meeting [m]: |w2 × w3| <= tolerance, and
  ///     axes 4, 5 and 6 pass their common point at distances <= tolerance; poses are missed by as much
  /// @throws InvalidInput that says which of these the arm is not, and by how much
  explicit SphericalWristInverse(const Arm& arm, double tolerance = 1e-9);

  /// Allocates nothing.
  /// @param flange  in B; a rotation, not checked
  /// @param hint    joints 1 and 4 where a singular posture leaves them free: the position before, say
  [[nodiscard]] InverseSolutions solve(const Eigen::Isometry3d& flange,
                                       const Position6& hint = Position6::Zero()) const noexcept;
  /// The point where axes 4, 5 and 6 meet, in the flange frame.
  [[nodiscard]] const Eigen::Vector3d& centre_m() const noexcept { return centre_m_; }

 private:
  struct Elbow;
  void detect_shoulder(const Posture& zero, const Eigen::Vector3d& centre, double tolerance);
  void detect_wrist(const Posture& zero, double tolerance);
  void add_shoulder(const Elbow& shoulder, InverseSolutions& out) const noexcept;
  void add_wrists(const Elbow& elbow, InverseSolutions& out) const noexcept;

  // Axis 1 with the frame (x across towards axis 2, y, z along axis 1) in B.
  Eigen::Vector3d origin_1_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d frame_1_ = Eigen::Matrix3d::Identity();
  double sin_12_ = 1.0, cos_12_ = 0.0;  // of the angle between axes 1 and 2
  double along_2_m_ = 0.0;              // of the wrist's centre from origin 1, along axis 2
  // The frame of axis 2 (z along it) in frame 1, and axis 2 itself.
  Eigen::Matrix3d frame_2_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_2_m_ = Eigen::Vector3d::Zero();
  // Upper arm and forearm in the plane across axis 2: lengths, and directions at zero.
  double upper_m_ = 0.0, fore_m_ = 0.0, upper_angle_ = 0.0, fore_angle_ = 0.0, sign_3_ = 1.0;
  double fore_cos_ = 1.0, fore_sin_ = 0.0;
  // The wrist: its centre and axis 6 (z; x across towards axis 5) in the flange frame, axis 4 (z; x across towards axis
  // 5) in frame 2.
  Eigen::Vector3d centre_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d frame_6_ = Eigen::Matrix3d::Identity(), frame_4_ = Eigen::Matrix3d::Identity();
  double sin_45_ = 1.0, cos_45_ = 0.0, sin_56_ = 1.0, cos_56_ = 0.0;
  double least_ = 0.0, most_ = 0.0;  // 1 - cos and 1 + cos of the least and the largest angle between axes 4 and 6
  double angle_5_ = 0.0;             // of the wrist at zero
  bool perpendicular_ = true;
};

/// The closed form of an arm; none for one without a spherical wrist, or otherwise not as the form asks.
[[nodiscard]] ROBOMILL_API std::optional<SphericalWristInverse> spherical_wrist(const Arm& arm);

}  // namespace robomill::robot
