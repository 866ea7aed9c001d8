#include "robomill/robot/inverse.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::robot {
namespace {

using std::numbers::pi;
/// A discriminant this little below zero, as a share of what it is the difference of, is rounding.
constexpr double rounding = 1e-10;
/// Below this size directions are undefined [m or rad].
constexpr double nothing = 1e-12;
/// Below this sine squared of the angle between axes 4 and 6, joint 6 is found from joint 4.
constexpr double nearly_straight = 1e-6;

/// Into (-π, π], from (-5π, 5π).
double wrapped(double angle) noexcept {
  while (angle > pi) angle -= 2.0 * pi;
  while (angle <= -pi) angle += 2.0 * pi;
  return angle;
}

[[noreturn]] void reject(const std::string& rule, double miss, const char* unit) {
  char number[32];
  std::snprintf(number, sizeof number, "%.3g", miss);
  throw InvalidInput("arm", rule + " (" + number + " " + unit + ")",
                     "Closed forms need a spherical wrist; solve_near takes any arm of six joints");
}

/// Across `along`, towards `target`; rejected by the caller where they are parallel.
Eigen::Vector3d across(const Eigen::Vector3d& along, const Eigen::Vector3d& target) {
  return (target - along.dot(target) * along).normalized();
}

/// Columns x across towards target, y, z along.
Eigen::Matrix3d frame_along(const Eigen::Vector3d& along, const Eigen::Vector3d& target) {
  Eigen::Matrix3d out;
  out.col(0) = across(along, target);
  out.col(1) = along.cross(out.col(0));
  out.col(2) = along;
  return out;
}

/// The point nearest to three lines.
Eigen::Vector3d meeting_point(const Posture::Axes& axis, const Posture::Axes& origin_m) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int i = 3; i < 6; ++i) {
    const Eigen::Matrix3d across_it = Eigen::Matrix3d::Identity() - axis.col(i) * axis.col(i).transpose();
    sum += across_it;
    right += across_it * origin_m.col(i);
  }
  return sum.partialPivLu().solve(right);
}

}  // namespace

/// Where the first three joints have brought the wrist.
struct SphericalWristInverse::Elbow {
  const Position6& hint;
  double angle_1 = 0.0, angle_2 = 0.0, angle_3 = 0.0, elbow_rad = 0.0;
  bool back = false, down = false;
  Eigen::Vector2d reach = Eigen::Vector2d::Zero();  // of the centre from axis 2, in frame 2 [m]
  Eigen::Matrix3d wrist = Eigen::Matrix3d::Zero();  // frame 6 in frame 2, and after the elbow in the forearm's frame
};

SphericalWristInverse::SphericalWristInverse(const Arm& arm, double tolerance) {
  arm.validate();
  require_positive("tolerance", tolerance, "rad");
  if (arm.joints.size() != 6) reject("must have six joints", static_cast<double>(arm.joints.size()), "joints");
  for (std::size_t i = 0; i < 6; ++i) {
    if (arm.joints[i].prismatic) reject("must have revolute joints alone", static_cast<double>(i + 1), "is prismatic");
  }
  Posture zero;
  zero.update(arm, Position6::Zero());
  const Eigen::Vector3d centre = meeting_point(zero.axis, zero.origin_m);
  // Where the last three axes do not meet there is no centre to speak of: that is reported first.
  detect_wrist(zero, tolerance);
  detect_shoulder(zero, centre, tolerance);
  const Eigen::Matrix3d to_frame_2 = frame_2_.transpose() * frame_1_.transpose();
  frame_4_ = to_frame_2 * frame_along(zero.axis.col(3), zero.axis.col(4));
}

void SphericalWristInverse::detect_wrist(const Posture& zero, double tolerance) {
  const Eigen::Vector3d w4 = zero.axis.col(3), w5 = zero.axis.col(4), w6 = zero.axis.col(5);
  sin_45_ = w4.cross(w5).norm();
  cos_45_ = w4.dot(w5);
  sin_56_ = w5.cross(w6).norm();
  cos_56_ = w5.dot(w6);
  if (sin_45_ < 1e-3) reject("must have axes 4 and 5 that are not parallel", sin_45_, "rad");
  if (sin_56_ < 1e-3) reject("must have axes 5 and 6 that are not parallel", sin_56_, "rad");
  const Eigen::Vector3d centre = meeting_point(zero.axis, zero.origin_m);
  double miss = 0.0;
  for (int i = 3; i < 6; ++i) {
    miss = std::max(miss, zero.axis.col(i).cross(centre - zero.origin_m.col(i)).norm());
  }
  if (!(miss <= tolerance))
    reject("must have axes 4, 5 and 6 that meet in one point: they pass it at a distance", miss, "m");
  const double beta = std::atan2(sin_45_, cos_45_), gamma = std::atan2(sin_56_, cos_56_);
  least_ = 2.0 * std::pow(std::sin(0.5 * (beta - gamma)), 2);
  most_ = 2.0 * std::pow(std::cos(0.5 * (beta + gamma)), 2);
  perpendicular_ = std::abs(cos_45_) < nothing && std::abs(cos_56_) < nothing;
  // Of axis 6 about axis 5 from the side of axis 4.
  const Eigen::Vector3d towards_4 = across(w5, w4);
  angle_5_ = std::atan2(w5.cross(towards_4).dot(w6), towards_4.dot(w6));
  const Eigen::Matrix3d to_flange = zero.flange.linear().transpose();
  frame_6_ = to_flange * frame_along(w6, w5);
  centre_m_ = zero.flange.inverse() * centre;
}

void SphericalWristInverse::detect_shoulder(const Posture& zero, const Eigen::Vector3d& centre, double tolerance) {
  const Posture::Axes& origin_m = zero.origin_m;
  const Eigen::Vector3d w1 = zero.axis.col(0), w2 = zero.axis.col(1), w3 = zero.axis.col(2);
  const double skew = w2.cross(w3).norm();
  if (!(skew <= tolerance)) reject("must have axes 2 and 3 that are parallel: they are off", skew, "rad");
  sign_3_ = w2.dot(w3) > 0.0 ? 1.0 : -1.0;
  sin_12_ = w1.cross(w2).norm();
  cos_12_ = w1.dot(w2);
  if (sin_12_ < 1e-3) reject("must have axes 1 and 2 that are not parallel", sin_12_, "rad");
  origin_1_m_ = origin_m.col(0);
  frame_1_ = frame_along(w1, w2);
  along_2_m_ = w2.dot(centre - origin_1_m_);
  const Eigen::Matrix3d frame_2 = frame_along(w2, w1);
  frame_2_ = frame_1_.transpose() * frame_2;
  origin_2_m_ = frame_1_.transpose() * (origin_m.col(1) - origin_1_m_);
  const Eigen::Vector3d upper = frame_2.transpose() * (origin_m.col(2) - origin_m.col(1));
  const Eigen::Vector3d fore = frame_2.transpose() * (centre - origin_m.col(2));
  upper_m_ = upper.head<2>().norm();
  fore_m_ = fore.head<2>().norm();
  if (!(upper_m_ > 1e-6)) reject("must have axes 2 and 3 apart", upper_m_, "m");
  if (!(fore_m_ > 1e-6)) reject("must have its wrist's centre apart from axis 3", fore_m_, "m");
  upper_angle_ = std::atan2(upper.y(), upper.x());
  fore_angle_ = std::atan2(fore.y(), fore.x());
  fore_cos_ = fore.x() / fore_m_;
  fore_sin_ = fore.y() / fore_m_;
}

InverseSolutions SphericalWristInverse::solve(const Eigen::Isometry3d& flange, const Position6& hint) const noexcept {
  InverseSolutions out;
  out.out_of_reach_m = out.out_of_reach_rad = HUGE_VAL;
  // In frame 1: cos θ1 x + sin θ1 y = across.
  const Eigen::Vector3d centre = frame_1_.transpose() * (flange * centre_m_ - origin_1_m_);
  const Eigen::Matrix3d wrist = frame_1_.transpose() * (flange.linear() * frame_6_);
  const double across = (along_2_m_ - cos_12_ * centre.z()) / sin_12_;
  const double squared = centre.x() * centre.x() + centre.y() * centre.y();
  const double from_axis = std::sqrt(squared);
  const double free = (from_axis - across) * (from_axis + across);
  const double height = std::sqrt(std::max(free, 0.0));
  out.shoulder_m = height;
  const bool on_axis = from_axis < nothing;
  if (free < -rounding * std::max(squared, upper_m_ * upper_m_)) {
    out.out_of_reach_m = std::abs(across) - from_axis;
  } else {
    const double middle = on_axis ? hint(0) : std::atan2(centre.y(), centre.x());
    const double half = on_axis ? 0.0 : std::atan2(height, across);
    const double hint_cos = on_axis ? std::cos(hint(0)) : 0.0, hint_sin = on_axis ? std::sin(hint(0)) : 0.0;
    out.shoulder_singular = on_axis;
    for (const double side : {1.0, -1.0}) {
      const double c = on_axis ? hint_cos : (centre.x() * across - side * centre.y() * height) / squared;
      const double s = on_axis ? hint_sin : (centre.y() * across + side * centre.x() * height) / squared;
      Eigen::Matrix3d back_turned;
      back_turned << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
      const Eigen::Matrix3d to_2 = frame_2_.transpose() * back_turned;
      Elbow shoulder{.hint = hint, .angle_1 = wrapped(middle + side * half), .back = side < 0.0};
      shoulder.reach = (to_2 * centre - frame_2_.transpose() * origin_2_m_).head<2>();
      shoulder.wrist.noalias() = to_2 * wrist;
      add_shoulder(shoulder, out);
      if (on_axis || half == 0.0) break;
    }
  }
  if (out.count > 0) {
    out.status = InverseSolutions::Status::found;
    out.out_of_reach_m = out.out_of_reach_rad = 0.0;
  }
  if (out.out_of_reach_m == HUGE_VAL) out.out_of_reach_m = 0.0;
  if (out.out_of_reach_rad == HUGE_VAL) out.out_of_reach_rad = 0.0;
  return out;
}

void SphericalWristInverse::add_shoulder(const Elbow& shoulder, InverseSolutions& out) const noexcept {
  const double reach_2 = shoulder.reach.squaredNorm(), reach = std::sqrt(reach_2);
  const double most = upper_m_ + fore_m_, least = std::abs(upper_m_ - fore_m_);
  // upper fore cos τ = bend, upper fore sin τ = ± height, τ from forearm to stretched.
  const double product = upper_m_ * fore_m_;
  const double free = 0.25 * ((most - reach) * (most + reach)) * ((reach - least) * (reach + least));
  if (free < -rounding * product * product) {
    out.out_of_reach_m = std::min(out.out_of_reach_m, std::max(reach - most, least - reach));
    return;
  }
  const double height = std::sqrt(std::max(free, 0.0));
  const double bend = 0.5 * (reach_2 - upper_m_ * upper_m_ - fore_m_ * fore_m_);
  const double lean = upper_m_ * upper_m_ + bend;
  const bool folded = reach < nothing;  // onto axis 2: joint 2 is free
  const double x = folded ? 1.0 : shoulder.reach.x() / reach, y = folded ? 0.0 : shoulder.reach.y() / reach;
  const double towards = std::atan2(y, x), turn = std::atan2(height, bend);
  const double lift = folded ? 0.0 : std::atan2(height, lean);
  // e^{i(θ2 + θ3)} = e^{i towards} e^{∓i lift} e^{±i τ} e^{-i fore}
  const double lean_size = std::hypot(lean, height), bend_size = std::hypot(bend, height);
  const double lift_cos = folded ? 1.0 : lean / lean_size, lift_sin = folded ? 0.0 : height / lean_size;
  const double turn_cos = bend / bend_size, turn_sin = height / bend_size;
  const double rest_cos = lift_cos * turn_cos + lift_sin * turn_sin,
               rest_sin = lift_cos * turn_sin - lift_sin * turn_cos;
  const double start_cos = x * fore_cos_ + y * fore_sin_, start_sin = y * fore_cos_ - x * fore_sin_;
  for (const double side : {1.0, -1.0}) {
    const double c = start_cos * rest_cos - side * start_sin * rest_sin;
    const double s = start_sin * rest_cos + side * start_cos * rest_sin;
    Elbow elbow = shoulder;
    elbow.angle_2 = wrapped(towards - upper_angle_ - side * lift);
    elbow.angle_3 = wrapped(sign_3_ * (side * turn - fore_angle_ + upper_angle_));
    elbow.elbow_rad = std::min(turn, pi - turn);
    elbow.down = side < 0.0;
    elbow.wrist.row(0) = c * shoulder.wrist.row(0) + s * shoulder.wrist.row(1);
    elbow.wrist.row(1) = c * shoulder.wrist.row(1) - s * shoulder.wrist.row(0);
    add_wrists(elbow, out);
    if (height == 0.0) break;
  }
}

void SphericalWristInverse::add_wrists(const Elbow& elbow, InverseSolutions& out) const noexcept {
  // Axis 6 in frame 4, and axis 4 in frame 6; each frame's x points to axis 5 at zero.
  const Eigen::Vector3d axis_6 = frame_4_.transpose() * elbow.wrist.col(2);
  const Eigen::Vector3d axis_4 = elbow.wrist.transpose() * frame_4_.col(2);
  const double straight = axis_6.x() * axis_6.x() + axis_6.y() * axis_6.y();
  // 1 ∓ cos of the angle between axes 4 and 6, without cancellation; then with τ the angle of joint 5 from the side of
  // axis 4: cos 45 cos 56 + sin 45 sin 56 cos τ is that cosine.
  const double less = 0.5 * (straight + (1.0 - axis_6.z()) * (1.0 - axis_6.z()));
  const double more = 0.5 * (straight + (1.0 + axis_6.z()) * (1.0 + axis_6.z()));
  const double free = (less - least_) * (more - most_);
  if (free < -rounding) {
    const double angle = std::atan2(std::sqrt(straight), axis_6.z());
    const double from = std::acos(std::clamp(1.0 - least_, -1.0, 1.0)),
                 to = std::acos(std::clamp(most_ - 1.0, -1.0, 1.0));
    out.out_of_reach_rad = std::min(out.out_of_reach_rad, std::max(from - angle, angle - to));
    return;
  }
  const double height = std::sqrt(std::max(free, 0.0));
  const double turn = std::atan2(height, axis_6.z() - cos_45_ * cos_56_);
  const bool on_line = straight < nothing * nothing;  // axes 4 and 6: joint 4 is free
  const double middle_4 = on_line ? elbow.hint(3) : std::atan2(axis_6.y(), axis_6.x());
  const double half_4 = on_line ? 0.0 : perpendicular_ ? 0.5 * pi : std::atan2(height, cos_56_ - cos_45_ * axis_6.z());
  const bool from_joint_4 = straight < nearly_straight;
  const double middle_6 = from_joint_4 ? 0.0 : std::atan2(axis_4.y(), axis_4.x());
  const double half_6 = from_joint_4     ? 0.0
                        : perpendicular_ ? 0.5 * pi
                                         : std::atan2(height, cos_45_ - cos_56_ * axis_6.z());
  out.wrist_singular = out.wrist_singular || on_line;
  for (const double side : {1.0, -1.0}) {
    InverseSolution& solution = out.solution[static_cast<std::size_t>(out.count++)];
    const double angle_4 = wrapped(middle_4 + side * half_4);
    double angle_6 = side * half_6 - middle_6;
    if (from_joint_4) {
      // Axis 5 in frame 4, seen from frame 6: its direction there is that of -θ6.
      const Eigen::Vector3d axis_5(sin_45_ * std::cos(angle_4), sin_45_ * std::sin(angle_4), cos_45_);
      const Eigen::Vector3d seen = elbow.wrist.transpose() * (frame_4_ * axis_5);
      angle_6 = -std::atan2(seen.y(), seen.x());
    }
    solution.position_rad << elbow.angle_1, elbow.angle_2, elbow.angle_3, angle_4, wrapped(side * turn - angle_5_),
        wrapped(angle_6);
    solution.shoulder_back = elbow.back;
    solution.elbow_down = elbow.down;
    solution.wrist_flipped = side < 0.0;
    solution.elbow_rad = elbow.elbow_rad;
    solution.wrist_rad = std::min(turn, pi - turn);
    if (height == 0.0 || on_line) break;
  }
}

std::optional<SphericalWristInverse> spherical_wrist(const Arm& arm) {
  try {
    return SphericalWristInverse(arm);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

}  // namespace robomill::robot
