#pragma once
// Arms that tests and benchmarks share.
#include <Eigen/Geometry>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::robot::testing {

inline constexpr double pi = std::numbers::pi;

/// The KUKA KR210 of [GbtAdl2023] in standard DH, with its joint stiffness.
inline Arm kr210() {
  Arm arm = arm_from_dh({{.a_m = 0.350, .alpha_rad = -pi / 2, .d_m = 0.4494},
                         {.a_m = 1.150, .theta_offset_rad = -pi / 2},
                         {.a_m = 0.041, .alpha_rad = -pi / 2, .theta_offset_rad = pi},
                         {.alpha_rad = pi / 2, .d_m = -1.200},
                         {.alpha_rad = -pi / 2},
                         {.alpha_rad = pi, .d_m = -0.420, .theta_offset_rad = pi}},
                        Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.2256)));
  const double stiffness[] = {2.2072e6, 3.37672e6, 2.77569e6, 2.35016e6, 2.15746e6, 0.467056e6};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) arm.joints[i].stiffness = stiffness[i];
  return arm;
}

/// A posture that the same model gives.
inline Eigen::VectorXd kr210_posture() {
  Eigen::VectorXd degrees(6);
  degrees << -10.09, 9.36, 17.81, 21.30, -28.85, -18.86;
  return degrees * (pi / 180.0);
}

/// Limits of the real arm's size, so that each joint can turn round or nearly.
inline Arm with_limits(Arm arm) {
  const double half[] = {185.0, 120.0, 150.0, 350.0, 125.0, 350.0};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    arm.joints[i].min_position = -half[i] * pi / 180.0;
    arm.joints[i].max_position = half[i] * pi / 180.0;
  }
  return arm;
}

/// An ABB IRB 6640-like arm.
inline Arm irb() {
  return arm_from_dh({{.a_m = 0.320, .alpha_rad = -pi / 2, .d_m = 0.780},
                      {.a_m = 1.075, .theta_offset_rad = -pi / 2},
                      {.a_m = 0.200, .alpha_rad = -pi / 2},
                      {.alpha_rad = pi / 2, .d_m = 1.142},
                      {.alpha_rad = -pi / 2},
                      {.d_m = 0.200, .theta_offset_rad = pi}});
}

/// A Universal Robots UR5e: its last three axes do not meet.
inline Arm ur5e() {
  return arm_from_dh({{.alpha_rad = pi / 2, .d_m = 0.1625},
                      {.a_m = -0.425},
                      {.a_m = -0.3922},
                      {.alpha_rad = pi / 2, .d_m = 0.1333},
                      {.alpha_rad = -pi / 2, .d_m = 0.0997},
                      {.d_m = 0.0996}});
}

inline Eigen::Vector3d random_vector(Random& random) {
  const double x = random.normal(), y = random.normal();
  return {x, y, random.normal()};
}

inline Eigen::Isometry3d random_pose(Random& random, double size_m) {
  const Eigen::Vector3d axis = random_vector(random).normalized();
  const double angle = random.uniform(-pi, pi);
  return Eigen::Translation3d(size_m * random_vector(random)) * Eigen::AngleAxisd(angle, axis);
}

inline Eigen::VectorXd random_position(Random& random, Eigen::Index size) {
  Eigen::VectorXd out(size);
  for (double& value : out) value = random.uniform(-pi, pi);
  return out;
}

/// A chain of n joints of no particular kind; every third runs along its axis.
inline Arm random_chain(Random& random, int n) {
  Arm arm;
  for (int i = 0; i < n; ++i) {
    Joint joint;
    joint.prismatic = i % 3 == 1;
    joint.before = random_pose(random, 0.5);
    joint.axis = random_vector(random).normalized();
    arm.joints.push_back(joint);
  }
  arm.flange = random_pose(random, 0.2);
  return arm;
}

}  // namespace robomill::robot::testing
