#include "robomill/robot/kinematics/parallel_axes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace robomill::robot {
namespace {

constexpr double parallel_sine = 0.01;  // calibrated arms are that far off
constexpr double apart_m = 1e-3;

double sine_between(const Posture& posture, Eigen::Index i, Eigen::Index j) {
  return posture.axis.col(i).cross(posture.axis.col(j)).norm();
}

/// From axis i to axis j, which are parallel, across them.
Eigen::Vector3d across(const Posture& posture, Eigen::Index i, Eigen::Index j) {
  const Eigen::Vector3d n = posture.axis.col(1);
  const Eigen::Vector3d way = posture.origin_m.col(j) - posture.origin_m.col(i);
  return way - way.dot(n) * n;
}

/// The point of axis 6 that is nearest to axis 5.
Eigen::Vector3d wrist_point(const Posture& posture) {
  const Eigen::Vector3d a = posture.axis.col(4), b = posture.axis.col(5);
  const Eigen::Vector3d way = posture.origin_m.col(4) - posture.origin_m.col(5);
  const double ab = a.dot(b);
  return posture.origin_m.col(5) + (b.dot(way) - ab * a.dot(way)) / (1.0 - ab * ab) * b;
}

/// Of an angle whose sine and cosine have these sizes, how far it is from 0 or half a turn.
double from_line(double sine, double cosine) {
  return std::atan2(std::abs(sine), std::abs(cosine));
}

}  // namespace

bool has_parallel_axes(const Arm& arm) {
  if (arm.joints.size() != 6 || std::ranges::any_of(arm.joints, [](const Joint& joint) { return joint.prismatic; })) {
    return false;
  }
  Posture posture;
  posture.update(arm, Eigen::VectorXd::Zero(6));
  return sine_between(posture, 1, 2) < parallel_sine && sine_between(posture, 2, 3) < parallel_sine &&
         sine_between(posture, 0, 1) > parallel_sine && sine_between(posture, 3, 4) > parallel_sine &&
         sine_between(posture, 4, 5) > parallel_sine && across(posture, 1, 2).norm() > apart_m &&
         across(posture, 2, 3).norm() > apart_m;
}

Configuration parallel_configuration(const Posture& posture) noexcept {
  const Eigen::Vector3d n = posture.axis.col(1), z1 = posture.axis.col(0);
  const Eigen::Vector3d upper = across(posture, 1, 2), lower = across(posture, 2, 3);
  const double elbow = upper.cross(lower).dot(n);
  const Eigen::Vector3d z5 = posture.axis.col(4), z6 = posture.axis.col(5);
  const double wrist = z5.cross(z6).dot(n);
  const Eigen::Vector3d forward = n.cross(z1).normalized();
  const double shoulder = (wrist_point(posture) - posture.origin_m.col(0)).dot(forward);
  return {.known = true,
          .parallel_axes = true,
          .shoulder_back = shoulder < 0.0,
          .elbow_down = elbow < 0.0,
          .wrist_flipped = wrist < 0.0,
          .shoulder_m = std::abs(shoulder),
          .elbow_rad = from_line(elbow, upper.dot(lower)),
          .wrist_rad = from_line(posture.axis.col(3).cross(z6).norm(), posture.axis.col(3).dot(z6))};
}

}  // namespace robomill::robot
