#include "robomill/path/published/fir_joint.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace robomill::path {

using Eigen::Vector3d;

namespace {

// Where a limit of acceleration or jerk is used up by the way's curvature, the pulse is stretched until this much of
// it is left to the filters.
constexpr double most_of_acceleration = 0.75, most_of_jerk = 0.25;

robot::ToolJet jet_at(const FirWay& way, const Vector3d& across, double angle, double share) {
  robot::ToolJet jet;
  const Vector3d whole = way.end.tip_m - way.begin.tip_m;
  jet.tip_m.col(0) = way.begin.tip_m + share * whole;
  jet.tip_m.col(1) = whole;
  const double c = std::cos(share * angle), s = std::sin(share * angle);
  jet.axis.col(0) = c * way.begin.axis + s * across;
  jet.axis.col(1) = angle * (c * across - s * way.begin.axis);
  jet.axis.col(2) = -angle * angle * jet.axis.col(0);
  jet.axis.col(3) = -angle * angle * jet.axis.col(1);
  const double turn = way.gamma_end_rad - way.gamma_begin_rad;
  jet.gamma_rad << way.gamma_begin_rad + share * turn, turn, 0.0, 0.0;
  return jet;
}

// The block by one joint.
struct FirStep {
  const std::vector<robot::JointJet>& joints;
  int joint;
  [[nodiscard]] double at(std::size_t i, int order) const { return joints[i](joint, order); }
  [[nodiscard]] double most(int order) const {
    double most = 0.0;
    for (const robot::JointJet& jet : joints) most = std::max(most, std::abs(jet(joint, order)));
    return most;
  }
};

// The share of the way over which the pulse enters the filters.
double reach_of(const FirConstants& c) {
  return std::min(0.5, 0.5 * (c.t2_s + c.t3_s) / c.t1_s);
}

// T2 by |q''| all along.
double t2_of_magnitudes(const FirStep& step, double limit, const FirConstants& c) {
  double t2 = 0.0;
  for (std::size_t i = 0; i < step.joints.size(); ++i) {
    const double left = limit - std::abs(step.at(i, 2)) / (c.t1_s * c.t1_s);
    t2 = std::max(t2, std::abs(step.at(i, 1)) / (c.t1_s * left));
  }
  return t2;
}

// T2 by the sign of q̈: s̈ > 0 only until the pulse has entered the filters, s̈ < 0 only while it leaves them, and there
// q'' counts where it adds to q' s̈.
double t2_of_signs(const FirStep& step, double limit, const FirConstants& c, bool as_printed) {
  const double reach = reach_of(c), last = static_cast<double>(step.joints.size() - 1);
  double t2 = 0.0;
  for (std::size_t i = 0; i < step.joints.size(); ++i) {
    const double share = static_cast<double>(i) / last, q1 = step.at(i, 1), q2 = step.at(i, 2);
    for (const double sign : {1.0, -1.0}) {
      if (sign > 0.0 ? share > reach : share < 1.0 - reach) continue;
      const double bend = std::copysign(1.0, q1 * sign) * q2 / (c.t1_s * c.t1_s);
      const double left = as_printed ? std::abs(limit - bend) : limit - std::max(0.0, bend);
      if (left > 0.0) t2 = std::max(t2, std::abs(q1) / (c.t1_s * left));
    }
  }
  return t2;
}

// Raises a constant to what is asked for. Longer filters reach further into the block, so that this is asked again.
template <class Needed>
void raise(double& constant, const Needed& needed) {
  for (int round = 0; round < 4; ++round) {
    const double value = needed();
    if (value <= constant) break;
    constant = value;
  }
}

// T3 for half the limit. At either end of a block s⃛ takes both signs, so both of the source's rows hold and the sign of
// q⃛ drops out; the terms count by their magnitudes, since opposite ones cancel at full speed and not on the way to it.
double t3_of_magnitudes(const FirStep& step, double limit, FirConstants& c) {
  const double q1 = step.most(1), q2 = step.most(2), q3 = step.most(3), half = 0.5 * limit;
  c.t1_s = std::max(c.t1_s, std::cbrt(q3 / (most_of_jerk * half)));
  c.t2_s = std::max(c.t2_s, 3.0 * q2 / (c.t1_s * c.t1_s * most_of_jerk * half));
  const double left = half - q3 / (c.t1_s * c.t1_s * c.t1_s) - 3.0 * q2 / (c.t1_s * c.t1_s * c.t2_s);
  return q1 / (c.t1_s * c.t2_s * left);
}

// The same as printed: point by point at full speed, with signs, the sum's excess over the limit hidden by an absolute
// value.
double t3_of_signs(const FirStep& step, double limit, const FirConstants& c) {
  const double reach = reach_of(c), last = static_cast<double>(step.joints.size() - 1), half = 0.5 * limit;
  double t3 = 0.0;
  for (std::size_t i = 0; i < step.joints.size(); ++i) {
    const double share = static_cast<double>(i) / last;
    for (const double sign : {1.0, -1.0}) {
      if (sign > 0.0 ? share > reach : share < 1.0 - reach) continue;
      const double bend = (step.at(i, 3) / c.t1_s + sign * 3.0 * step.at(i, 2) / c.t2_s) / (c.t1_s * c.t1_s);
      const double left = std::abs(half - std::abs(bend));  // the worse row
      if (left > 0.0) t3 = std::max(t3, std::abs(step.at(i, 1)) / (c.t1_s * c.t2_s * left));
    }
  }
  return t3;
}

}  // namespace

robot::Reach joints_along(const robot::Kinematics& kinematics, const FirWay& way, robot::Position6& near,
                          std::vector<robot::JointJet>& out) {
  out.clear();
  const double angle = program::angle_between(way.begin.axis, way.end.axis);
  const Vector3d aside = way.end.axis - way.end.axis.dot(way.begin.axis) * way.begin.axis;
  const Vector3d across = aside.norm() > 0.0 ? Vector3d(aside.normalized()) : Vector3d(Vector3d::Zero());
  // A point a millimetre or half a degree, 33 at most: limits are not used up to the last thousandth between them.
  const double size = (way.end.tip_m - way.begin.tip_m).norm() / 1e-3 + angle / 0.01;
  const int steps = static_cast<int>(std::clamp(size, 2.0, 32.0));
  robot::Reach reach;
  for (int i = 0; i <= steps; ++i) {
    robot::JointJet joints;
    reach = kinematics.follow(jet_at(way, across, angle, static_cast<double>(i) / steps), near, joints);
    if (reach.status != robot::Reach::Status::found) return reach;
    near = joints.col(0);
    out.push_back(joints);
  }
  return reach;
}

void stretch_for_joints(const std::vector<robot::JointJet>& joints, const robot::JointLimits& limits, int count,
                        const SmoothingOptions& options, FirConstants& constants) {
  const bool printed = options.method == Method::paper_as_printed;
  FirConstants& c = constants;
  for (int j = 0; j < count; ++j) {
    const FirStep step = {.joints = joints, .joint = j};
    c.t1_s = std::max(c.t1_s, step.most(1) / limits.max_velocity[j]);
    if (!printed)
      c.t1_s = std::max(c.t1_s, std::sqrt(step.most(2) / (most_of_acceleration * limits.max_acceleration[j])));
  }
  for (int j = 0; j < count; ++j) {
    const FirStep step = {.joints = joints, .joint = j};
    const double limit = limits.max_acceleration[j];
    if (options.method == Method::no_joint_jerk) {
      c.t2_s = std::max(c.t2_s, t2_of_magnitudes(step, limit, c));
      continue;
    }
    raise(c.t2_s, [&] { return t2_of_signs(step, limit, c, printed); });
  }
  if (options.method == Method::no_joint_jerk || options.filters < 2) return;
  for (int j = 0; j < count; ++j) {
    const FirStep step = {.joints = joints, .joint = j};
    const double limit = limits.max_jerk[j];
    if (!printed) {
      c.t3_s = std::max(c.t3_s, t3_of_magnitudes(step, limit, c));
      continue;
    }
    raise(c.t3_s, [&] { return t3_of_signs(step, limit, c); });
  }
}

}  // namespace robomill::path
