#pragma once
// A machine for tests whose kinematics can be read at a glance: three slides that carry a head with two tilts,
// tip = (q1, q2, q3) − pivot axis, axis = Rx(q4) Ry(q5) e_z.
#include <Eigen/Core>
#include <cmath>

#include "robomill/robot/kinematics.hpp"

namespace robomill::path::test {

class TiltHead final : public robot::Kinematics {
 public:
  explicit TiltHead(const robot::JointLimits& limits, double pivot_m = 0.15) : limits_(limits), pivot_m_(pivot_m) {}

  [[nodiscard]] int joints() const noexcept override { return 5; }
  [[nodiscard]] const robot::JointLimits& limits() const noexcept override { return limits_; }
  [[nodiscard]] bool turns_about_axis() const noexcept override { return false; }
  [[nodiscard]] int all(const robot::ToolPose& pose, robot::Position6* out, int room) const noexcept override {
    if (room < 1 || follow(pose, robot::Position6::Zero(), out[0]).status != robot::Reach::Status::found) return 0;
    return 1;
  }
  [[nodiscard]] robot::Reach follow(const robot::ToolPose& pose, const robot::Position6& near,
                                    robot::Position6& position) const noexcept override {
    robot::ToolJet jet;
    jet.tip_m.col(0) = pose.tip_m;
    jet.axis.col(0) = pose.axis;
    robot::JointJet joints;
    const robot::Reach reach = follow(jet, near, joints);
    position = joints.col(0);
    return reach;
  }
  [[nodiscard]] robot::Reach follow(const robot::ToolJet& jet, const robot::Position6& /*near*/,
                                    robot::JointJet& joints) const noexcept override {
    joints.setZero();
    joints.topRows<3>() = jet.tip_m + pivot_m_ * jet.axis;
    const auto& x = jet.axis.row(0);  // sin q5
    const double b = std::asin(x[0]), s = x[0], c = std::sqrt(1.0 - s * s);
    const double b1 = x[1] / c, b2 = (x[2] + s * b1 * b1) / c, b3 = (x[3] + 3.0 * s * b1 * b2 + c * b1 * b1 * b1) / c;
    joints.row(4) << b, b1, b2, b3;
    const Eigen::RowVector4d u = -jet.axis.row(1), w = jet.axis.row(2);  // tan q4 = u / w
    const double p0 = w[0] * u[1] - u[0] * w[1], p1 = w[0] * u[2] - u[0] * w[2];
    const double p2 = w[0] * u[3] + w[1] * u[2] - u[1] * w[2] - u[0] * w[3];
    const double q0 = u[0] * u[0] + w[0] * w[0], q1 = 2.0 * (u[0] * u[1] + w[0] * w[1]);
    const double q2 = 2.0 * (u[1] * u[1] + u[0] * u[2] + w[1] * w[1] + w[0] * w[2]);
    const double a1 = p0 / q0, a2 = (p1 - a1 * q1) / q0, a3 = (p2 - 2.0 * a2 * q1 - a1 * q2) / q0;
    joints.row(3) << std::atan2(u[0], w[0]), a1, a2, a3;
    robot::Reach reach;
    reach.status = robot::Reach::Status::found;
    for (int j = 0; j < 5; ++j) {
      if (joints(j, 0) >= limits_.min_position[j] && joints(j, 0) <= limits_.max_position[j]) continue;
      reach.status = robot::Reach::Status::outside_limits;
      reach.joint = j;
      reach.beyond = std::max(limits_.min_position[j] - joints(j, 0), joints(j, 0) - limits_.max_position[j]);
    }
    return reach;
  }
  [[nodiscard]] robot::ToolPose forward(const robot::Position6& position) const noexcept override {
    robot::ToolPose pose;
    const double a = position[3], b = position[4];
    pose.axis = {std::sin(b), -std::sin(a) * std::cos(b), std::cos(a) * std::cos(b)};
    pose.tip_m = position.head<3>() - pivot_m_ * pose.axis;
    return pose;
  }
  [[nodiscard]] double regularity(const robot::Position6& position) const noexcept override {
    return std::abs(std::cos(position[4]));
  }

 private:
  robot::JointLimits limits_;
  double pivot_m_;
};

/// Slides of 1 m/s, 5 m/s², 100 m/s³ and tilts of 1 rad/s, 5 rad/s², 100 rad/s³ by default.
inline robot::JointLimits tilt_head_limits() {
  robot::JointLimits limits;
  limits.min_position << -1.0, -1.0, -1.0, -1.5, -1.5, 0.0;
  limits.max_position << 1.0, 1.0, 1.0, 1.5, 1.5, 0.0;
  limits.max_velocity << 1.0, 1.0, 1.0, 1.0, 1.0, 0.0;
  limits.max_acceleration << 5.0, 5.0, 5.0, 5.0, 5.0, 0.0;
  limits.max_jerk << 100.0, 100.0, 100.0, 100.0, 100.0, 0.0;
  return limits;
}

}  // namespace robomill::path::test
