#include "robomill/robot/hybrid.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/robot/condition.hpp"
#include "robomill/robot/taylor.hpp"

namespace robomill::robot {
namespace {

constexpr int legs_and_slides = 5;

/// The machine's joints for tip p and direction t in its frame, t_z > 0; of numbers or of Taylor series.
template <class T>
std::array<T, 5> joints_of(const HybridMachine& machine, const std::array<T, 3>& p, const std::array<T, 3>& t,
                           T& height) noexcept {
  using std::sqrt;
  const T a = machine.base_half_width_m, b = machine.platform_half_width_m, c = machine.platform_offset_m,
          e = machine.base_offset_m, h = machine.tool_offset_m();
  const T cos_beta = sqrt(t[1] * t[1] + t[2] * t[2]), cos_alpha = t[2] / cos_beta, sin_alpha = T(0.0) - t[1] / cos_beta;
  height = p[2] / cos_alpha - h * cos_beta;
  const T across = b * cos_beta - a, near = height - b * t[0], far = height + b * t[0];
  // B3 − A3 in the plane x = 0, turned back by α.
  const T out = c - e * cos_alpha, up = height + e * sin_alpha;
  return {sqrt(across * across + near * near), sqrt(across * across + far * far), sqrt(out * out + up * up),
          p[0] - h * t[0], p[1] - p[2] * (t[1] / t[2])};
}

/// How much higher the platform must stand to be on the side of the legs' singularities on which it is built [m]:
/// ℓ² cos β > a b sin² β, and B3 above the base's plane, c sin α + ℓ cos α > 0.
double missing_height(const HybridMachine& machine, const HybridKinematics::Stand& at) noexcept {
  const double of_legs =
      std::abs(at.sin_beta) * std::sqrt(machine.base_half_width_m * machine.platform_half_width_m / at.cos_beta);
  return std::max(of_legs, -machine.platform_offset_m * at.sin_alpha / at.cos_alpha) - at.height_m;
}

/// Largest over smallest singular value, of five columns in the frame of condition_of's six: the sixth value lies
/// between the others.
double condition_of_five(const Eigen::Matrix<double, 5, 5>& matrix) noexcept {
  if (!matrix.allFinite()) return HUGE_VAL;
  Eigen::Matrix<double, 6, 6> wide = Eigen::Matrix<double, 6, 6>::Zero();
  wide.topLeftCorner<5, 5>() = matrix;
  wide(5, 5) = matrix.norm() / std::sqrt(5.0);
  return condition_of(wide, 1.0);
}

}  // namespace

void HybridMachine::validate() const {
  require_positive("base_half_width_m", base_half_width_m, "m");
  require_positive("platform_half_width_m", platform_half_width_m, "m");
  require_finite("platform_offset_m", platform_offset_m, "m");
  require_positive("base_offset_m", base_offset_m, "m");
  require_non_negative("platform_to_flange_m", platform_to_flange_m, "m");
  require_non_negative("tool_length_m", tool_length_m, "m");
  const Eigen::Matrix3d product = workpiece.linear().transpose() * workpiece.linear();
  if (!workpiece.matrix().allFinite() || !product.isIdentity(1e-6) || workpiece.linear().determinant() < 0.0) {
    throw InvalidInput("workpiece", "must hold a rotation, R^T R = 1 and det R = 1");
  }
  for (int i = 0; i < legs_and_slides; ++i) {
    if (limits.min_position(i) < limits.max_position(i)) continue;
    throw InvalidInput("limits.min_position[" + std::to_string(i + 1) + "]", limits.min_position(i), "m",
                       "must be below max_position", "Are the two lists exchanged?");
  }
}

void HybridOptions::validate() const {
  try {
    singularity.validate();
  } catch (const InvalidInput& error) {
    throw within("singularity.", error);
  }
  if (!(max_travel_m > 0.0)) throw InvalidInput("max_travel_m", max_travel_m, "m", "must be > 0");
}

HybridKinematics::HybridKinematics(const HybridMachine& machine, const HybridOptions& options)
    : machine_(machine), options_(options) {
  machine.validate();
  options.validate();
}

PlatformPose HybridKinematics::platform(const Position6& position) const noexcept {
  const double a = machine_.base_half_width_m, b = machine_.platform_half_width_m, c = machine_.platform_offset_m,
               e = machine_.base_offset_m;
  const double q1 = position(0), q2 = position(1), q3 = position(2);
  const double sum = 0.5 * (q1 * q1 + q2 * q2) - a * a - b * b, difference = 0.25 * (q2 - q1) * (q2 + q1);
  // Of f(m) = m (m − S)² + 4 a² (D² − b² m): f > 0 and convex to the right of its largest root, so Newton comes down
  // to it from the most that m can be, S + 2 a b (β = 0).
  double square = sum + 2.0 * a * b;
  for (int round = 0; round < 60; ++round) {
    const double over = square - sum;
    const double value = square * over * over + 4.0 * a * a * (difference * difference - b * b * square);
    const double slope = over * over + 2.0 * square * over - 4.0 * a * a * b * b;
    const double next = square - value / slope;
    if (!(next < square)) break;
    square = next;
  }
  PlatformPose out;
  out.height_m = std::sqrt(square);
  out.beta_rad = std::atan2(2.0 * a * difference, out.height_m * (square - sum));
  // c cos α − ℓ sin α = r cos(α + δ), and B3 stands above the base's plane: sin(α + δ) > 0.
  const double from = (c * c + square + e * e - q3 * q3) / (2.0 * e);
  out.alpha_rad = std::acos(from / std::hypot(c, out.height_m)) - std::atan2(out.height_m, c);
  return out;
}

int HybridKinematics::all(const ToolPose& pose, Position6* out, int room) const noexcept {
  Position6 position;
  const Reach reach = follow(pose, Position6::Zero(), position);
  if (room < 1 || (reach.status != Reach::Status::found && reach.status != Reach::Status::jump)) return 0;
  out[0] = position;
  return 1;
}

Reach HybridKinematics::follow(const ToolPose& pose, const Position6& near, Position6& position) const noexcept {
  const Eigen::Vector3d tip = machine_.workpiece * pose.tip_m, down = -(machine_.workpiece.linear() * pose.axis);
  position.setZero();
  if (!(down.z() > 0.0)) return {};
  double height = 0.0;
  const std::array<double, 5> joints =
      joints_of<double>(machine_, {tip.x(), tip.y(), tip.z()}, {down.x(), down.y(), down.z()}, height);
  for (int i = 0; i < legs_and_slides; ++i) position(i) = joints[static_cast<std::size_t>(i)];
  const double across = std::sqrt(down.y() * down.y() + down.z() * down.z());
  const Stand at{.sin_alpha = -down.y() / across,
                 .cos_alpha = down.z() / across,
                 .sin_beta = down.x(),
                 .cos_beta = across,
                 .height_m = height};
  const double missing = missing_height(machine_, at);
  if (!(missing < 0.0)) return {.beyond = missing};
  return check(position, near, at);
}

Reach HybridKinematics::follow(const ToolJet& jet, const Position6& near, JointJet& joints) const noexcept {
  Position6 position;
  const Reach reach = follow(ToolPose{.tip_m = jet.tip_m.col(0), .axis = jet.axis.col(0)}, near, position);
  joints.setZero();
  joints.col(0) = position;
  if (reach.status != Reach::Status::found) return reach;
  Eigen::Matrix<double, 3, 4> tip = machine_.workpiece.linear() * jet.tip_m;
  tip.col(0) += machine_.workpiece.translation();
  const Eigen::Matrix<double, 3, 4> down = -(machine_.workpiece.linear() * jet.axis);
  Taylor height;
  const std::array<Taylor, 5> series =
      joints_of<Taylor>(machine_, {Taylor::of(tip.row(0)), Taylor::of(tip.row(1)), Taylor::of(tip.row(2))},
                        {Taylor::of(down.row(0)), Taylor::of(down.row(1)), Taylor::of(down.row(2))}, height);
  for (int i = 0; i < legs_and_slides; ++i) {
    for (int order = 1; order < 4; ++order) {
      joints(i, order) = series[static_cast<std::size_t>(i)].derivative(order);
    }
  }
  return reach;
}

ToolPose HybridKinematics::forward(const Position6& position) const noexcept {
  const PlatformPose at = platform(position);
  const double h = machine_.tool_offset_m(), sa = std::sin(at.alpha_rad), ca = std::cos(at.alpha_rad),
               sb = std::sin(at.beta_rad), cb = std::cos(at.beta_rad), reach = at.height_m + h * cb;
  const Eigen::Vector3d tip(position(3) + h * sb, position(4) - reach * sa, reach * ca), down(sb, -cb * sa, cb * ca);
  const Eigen::Isometry3d back = machine_.workpiece.inverse();
  return {.tip_m = back * tip, .axis = -(back.linear() * down)};
}

double HybridKinematics::regularity(const Position6& position) const noexcept {
  const PlatformPose at = platform(position);
  return 1.0 / condition_of_five(rates(position, {.sin_alpha = std::sin(at.alpha_rad),
                                                  .cos_alpha = std::cos(at.alpha_rad),
                                                  .sin_beta = std::sin(at.beta_rad),
                                                  .cos_beta = std::cos(at.beta_rad),
                                                  .height_m = at.height_m})
                                     .forth);
}

/// From those of the legs and of the tool by (X, Y, α, β, ℓ); both have few entries, and their inverses stand here.
HybridKinematics::Rates HybridKinematics::rates(const Position6& position, const Stand& at) const noexcept {
  const double a = machine_.base_half_width_m, b = machine_.platform_half_width_m, c = machine_.platform_offset_m,
               e = machine_.base_offset_m, h = machine_.tool_offset_m(), l = at.height_m;
  const double sa = at.sin_alpha, ca = at.cos_alpha, sb = at.sin_beta, cb = at.cos_beta;
  const double by_q1 = 1.0 / position(0), by_q2 = 1.0 / position(1), by_q3 = 1.0 / position(2), by_ca = 1.0 / ca;
  // Legs 1 and 2 by (β, ℓ), leg 3 by (α, ℓ).
  const double first_beta = b * (a * sb - l * cb) * by_q1, first_height = (l - b * sb) * by_q1;
  const double second_beta = b * (a * sb + l * cb) * by_q2, second_height = (l + b * sb) * by_q2;
  const double third_alpha = e * (c * sa + l * ca) * by_q3, third_height = (l + e * sa) * by_q3;
  // The tip by α, β, ℓ; the axis' angles in units of length.
  const double reach = l + h * cb, unit = options_.singularity.characteristic_length_m;
  const double y_alpha = -reach * ca, y_beta = h * sb * sa, z_alpha = -reach * sa, z_beta = -h * sb * ca;

  Rates of;
  // (X, Y, α, β, ℓ) by the tool's five.
  Row5 alpha = Row5::Zero(), beta = Row5::Zero(), height = Row5::Zero();
  alpha(3) = 1.0 / (unit * cb);
  beta(4) = 1.0 / unit;
  height << 0.0, 0.0, by_ca, -z_alpha * alpha(3) * by_ca, -z_beta * beta(4) * by_ca;
  of.forth.row(0) = first_beta * beta + first_height * height;
  of.forth.row(1) = second_beta * beta + second_height * height;
  of.forth.row(2) = third_alpha * alpha + third_height * height;
  of.forth.row(3) << 1.0, 0.0, 0.0, 0.0, -h * cb * beta(4);
  of.forth.row(4) = -y_alpha * alpha - y_beta * beta + sa * height;
  of.forth(4, 1) += 1.0;
  // … and by the joints.
  const double inverse = 1.0 / (first_beta * second_height - second_beta * first_height), by_third = 1.0 / third_alpha;
  beta << second_height * inverse, -first_height * inverse, 0.0, 0.0, 0.0;
  height << -second_beta * inverse, first_beta * inverse, 0.0, 0.0, 0.0;
  alpha = -third_height * by_third * height;
  alpha(2) = by_third;
  of.back.row(0) = h * cb * beta;
  of.back(0, 3) += 1.0;
  of.back.row(1) = y_alpha * alpha + y_beta * beta - sa * height;
  of.back(1, 4) += 1.0;
  of.back.row(2) = z_alpha * alpha + z_beta * beta + ca * height;
  of.back.row(3) = unit * cb * alpha;
  of.back.row(4) = unit * beta;
  return of;
}

Reach HybridKinematics::check(const Position6& position, const Position6& near, const Stand& at) const noexcept {
  Reach out{.status = Reach::Status::found};
  for (int i = 0; i < legs_and_slides; ++i) {
    const double beyond =
        std::max(machine_.limits.min_position(i) - position(i), position(i) - machine_.limits.max_position(i));
    if (beyond > out.beyond) out = {.status = Reach::Status::outside_limits, .joint = i, .beyond = beyond};
  }
  if (out.joint >= 0) return out;
  const auto [forth, back] = rates(position, at);
  const double most = options_.singularity.max_condition_number;
  // Of Frobenius norms: never below the condition number, and cheap.
  if (!(forth.norm() * back.norm() <= most) && !(condition_of_five(forth) <= most)) {
    out.status = Reach::Status::singular;
    if (forth.norm() > back.norm()) {
      forth.rowwise().squaredNorm().maxCoeff(&out.joint);
    } else {
      back.colwise().squaredNorm().maxCoeff(&out.joint);
    }
    return out;
  }
  if ((position - near).cwiseAbs().maxCoeff() > options_.max_travel_m) out.status = Reach::Status::jump;
  return out;
}

}  // namespace robomill::robot
