#include "robomill/robot/serial_kinematics.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/robot/condition.hpp"
#include "robomill/robot/kinematics/images.hpp"
#include "robomill/robot/kinematics/newton.hpp"
#include "robomill/robot/kinematics/parallel_axes.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::robot {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Newton's steps stop at the first, and what rounding leaves above it is taken up to the second [m and rad].
constexpr double wanted_error = 1e-13, accepted_error = 1e-11;
const NearOptions steps{.tolerance_m = wanted_error, .tolerance_rad = wanted_error, .max_iterations = 40};
/// Seeds from which an arm without closed form looks for all its branches, and how many in a row that find nothing new
/// end the search.
constexpr int seeds = 400, fruitless = 100;
constexpr int most_branches = 32;

/// Motion of a body: velocity of the point of it that is where the tip is (3), angular velocity (3).
Position6 cross(const Position6& twist, const Position6& screw) noexcept {
  const Eigen::Vector3d v = twist.head<3>(), w = twist.tail<3>(), m = screw.head<3>(), a = screw.tail<3>();
  Position6 out;
  out << w.cross(m) + v.cross(a), w.cross(a);
  return out;
}

/// The flange's twist and its first two derivatives by u, in W, a column each; false where gamma has no reference.
bool twists(const ToolJet& jet, Eigen::Matrix<double, 6, 3>& out) noexcept {
  const auto o = [&](int order) { return Eigen::Vector3d(jet.axis.col(order)); };
  const auto i = [&](int order) { return jet.axis(0, order); };
  const auto j = [&](int order) { return jet.axis(1, order); };
  const auto k = [&](int order) { return jet.axis(2, order); };
  const double below = k(0) < 0.0 ? (i(0) * i(0) + j(0) * j(0)) / (1.0 - k(0)) : 1.0 + k(0);
  if (!(below > 1e-12)) return false;
  const double spun = i(0) * j(1) - j(0) * i(1), spun_1 = i(0) * j(2) - j(0) * i(2),
               spun_2 = i(1) * j(2) - j(1) * i(2) + i(0) * j(3) - j(0) * i(3);
  // Of the quotient spun / below.
  const double s0 = spun / below, s1 = (spun_1 - s0 * k(1)) / below,
               s2 = (spun_2 - 2.0 * s1 * k(1) - s0 * k(2)) / below;
  const double t0 = jet.gamma_rad(1) - s0, t1 = jet.gamma_rad(2) - s1, t2 = jet.gamma_rad(3) - s2;
  out.topRows<3>() = jet.tip_m.rightCols<3>();
  const Eigen::Vector3d w0 = o(0).cross(o(1)) + t0 * o(0);
  const Eigen::Vector3d w1 = o(0).cross(o(2)) + t1 * o(0) + t0 * o(1);
  const Eigen::Vector3d w2 = o(1).cross(o(2)) + o(0).cross(o(3)) + t2 * o(0) + 2.0 * t1 * o(1) + t0 * o(2);
  // Of the point of space where the tip is now: d(tip' + ω × (point − tip)) with the point standing still.
  const Eigen::Vector3d v = jet.tip_m.col(1), a = jet.tip_m.col(2);
  out.block<3, 1>(0, 1) -= w0.cross(v);
  out.block<3, 1>(0, 2) -= 2.0 * w1.cross(v) + w0.cross(a);
  out.block<3, 1>(3, 0) = w0;
  out.block<3, 1>(3, 1) = w1;
  out.block<3, 1>(3, 2) = w2;
  return true;
}

}  // namespace

/// The joints' screws at the tip, in B, and what undoes them.
struct SerialKinematics::Screws {
  Matrix6 jacobian, inverse;
};

void SerialOptions::validate() const {
  try {
    singularity.validate();
  } catch (const InvalidInput& error) {
    throw within("singularity.", error);
  }
  if (!(max_travel_rad > 0.0)) throw InvalidInput("max_travel_rad", max_travel_rad, "rad", "must be > 0");
}

SerialKinematics::SerialKinematics(const Cell& cell, const SerialOptions& options) : cell_(cell), options_(options) {
  options.validate();
  try {
    cell.validate();
  } catch (const InvalidInput& error) {
    throw within("cell.", error);
  }
  if (cell.arm.joints.size() != 6) {
    throw InvalidInput("cell.arm.joints", static_cast<double>(cell.arm.joints.size()), "joints", "must be six");
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const Joint& joint = cell.arm.joints[i];
    const auto row = static_cast<Eigen::Index>(i);
    if (joint.prismatic) {
      throw InvalidInput("cell.arm.joints", "must all be revolute; joint " + std::to_string(i + 1) + " is prismatic");
    }
    limits_.min_position(row) = joint.min_position;
    limits_.max_position(row) = joint.max_position;
    limits_.max_velocity(row) = joint.max_velocity;
    limits_.max_acceleration(row) = joint.max_acceleration;
    limits_.max_jerk(row) = joint.max_jerk;
  }
  try {
    inverse_.emplace(cell.arm);
  } catch (const InvalidInput&) {
    inverse_.reset();  // no spherical wrist: Newton's steps serve
    parallel_axes_ = has_parallel_axes(cell.arm);
  }
}

Reach SerialKinematics::place(const Eigen::Isometry3d& flange, const Position6& near, Position6& position,
                              Posture& posture) const noexcept {
  Placed placed;
  if (inverse_) {
    const InverseSolutions solutions = inverse_->solve(flange, near);
    if (solutions.count == 0) {
      return {.beyond = solutions.out_of_reach_m > 0.0 ? solutions.out_of_reach_m : solutions.out_of_reach_rad};
    }
    placed = pick(cell_.arm, solutions, near, Position6::Ones()).placed;
    posture.update(cell_.arm, placed.position_rad);
  } else {
    Position6 found = near;
    Matrix6 jac;
    if (!newton_nearby(cell_.arm, flange, wanted_error, found, posture, jac)) {
      found = near;
      const NewtonEnd end = newton(cell_.arm, flange, found, steps);
      if (!(end.error_m <= accepted_error && end.error_rad <= accepted_error)) return {.beyond = end.error_m};
      posture.update(cell_.arm, found);
    }
    placed = robot::place(cell_.arm, found, near, Position6::Ones());
  }
  position = placed.position_rad;
  if (placed.joint < 0) return {.status = Reach::Status::found};
  return {
      .status = Reach::Status::outside_limits, .joint = static_cast<int>(placed.joint), .beyond = placed.beyond_rad};
}

/// Of a spherical wrist the Jacobian at its centre is [A 0; B C] with 3 x 3 blocks.
void SerialKinematics::undo(const Posture& posture, Screws& screws) const noexcept {
  if (!inverse_) {
    screws.inverse = screws.jacobian.partialPivLu().inverse();
    return;
  }
  const Eigen::Vector3d centre = posture.flange * inverse_->centre_m(), tip = posture.flange * tip_point(cell_);
  Eigen::Matrix3d moves;
  for (int i = 0; i < 3; ++i) {
    moves.col(i) = Eigen::Vector3d(posture.axis.col(i)).cross(Eigen::Vector3d(centre - posture.origin_m.col(i)));
  }
  const Eigen::Matrix3d by_move = moves.inverse(), by_turn = screws.jacobian.bottomRightCorner<3, 3>().inverse();
  Matrix6& out = screws.inverse;
  out.topLeftCorner<3, 3>() = by_move;
  out.topRightCorner<3, 3>().setZero();
  out.bottomLeftCorner<3, 3>().noalias() = -by_turn * (screws.jacobian.bottomLeftCorner<3, 3>() * by_move);
  out.bottomRightCorner<3, 3>() = by_turn;
  // From the tip's velocity to the centre's: v + ω × (centre − tip).
  const Eigen::Vector3d lever = centre - tip;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d row = out.block<1, 3>(i, 0).transpose();
    out.block<1, 3>(i, 3) += lever.cross(row).transpose();
  }
}

Reach SerialKinematics::reach(const ToolPose& pose, const Position6& near, Position6& position,
                              Screws& screws) const noexcept {
  position = near;
  Posture posture;
  Reach out = place(flange_pose(cell_, pose), near, position, posture);
  if (out.status != Reach::Status::found) return out;
  posture.jacobian(cell_.arm, posture.flange * tip_point(cell_), screws.jacobian);
  undo(posture, screws);
  // The condition number of Frobenius' norms is never the smaller one, and cheap.
  const double length = options_.singularity.characteristic_length_m, most = options_.singularity.max_condition_number;
  const double forth =
      screws.jacobian.topRows<3>().squaredNorm() / (length * length) + screws.jacobian.bottomRows<3>().squaredNorm();
  const double back =
      screws.inverse.leftCols<3>().squaredNorm() * length * length + screws.inverse.rightCols<3>().squaredNorm();
  if (!(forth * back <= most * most) && !(condition_of(screws.jacobian, length) <= most)) {
    out.status = Reach::Status::singular;
    screws.inverse.rowwise().squaredNorm().maxCoeff(&out.joint);
    return out;
  }
  if ((position - near).cwiseAbs().maxCoeff() > options_.max_travel_rad) out.status = Reach::Status::jump;
  return out;
}

Reach SerialKinematics::follow(const ToolPose& pose, const Position6& near, Position6& position) const noexcept {
  Screws screws;
  return reach(pose, near, position, screws);
}

Reach SerialKinematics::follow(const ToolJet& jet, const Position6& near, JointJet& joints) const noexcept {
  Screws screws;
  Position6 position;
  Reach out = reach({.tip_m = jet.tip_m.col(0), .axis = jet.axis.col(0), .gamma_rad = jet.gamma_rad(0)}, near, position,
                    screws);
  joints.setZero();
  joints.col(0) = position;
  if (out.status != Reach::Status::found) return out;
  Eigen::Matrix<double, 6, 3> twist;
  if (!twists(jet, twist)) {
    out.status = Reach::Status::singular;
    return out;
  }
  const Eigen::Matrix3d turned = cell_.workpiece.linear();
  for (int order = 0; order < 3; ++order) {
    twist.block<3, 1>(0, order) = turned * Eigen::Vector3d(twist.block<3, 1>(0, order));
    twist.block<3, 1>(3, order) = turned * Eigen::Vector3d(twist.block<3, 1>(3, order));
  }
  const Position6 q1 = screws.inverse * twist.col(0);
  // S_i' along the chain, with the twist of the joints below.
  Matrix6 first;
  Position6 below = Position6::Zero(), left = twist.col(1);
  for (int i = 0; i < 6; ++i) {
    first.col(i) = cross(below, screws.jacobian.col(i));
    below += screws.jacobian.col(i) * q1(i);
    left -= first.col(i) * q1(i);
  }
  const Position6 q2 = screws.inverse * left;
  Position6 below_1 = Position6::Zero();
  below.setZero();
  left = twist.col(2);
  for (int i = 0; i < 6; ++i) {
    const Position6 second = cross(below_1, screws.jacobian.col(i)) + cross(below, first.col(i));
    left -= 2.0 * first.col(i) * q2(i) + second * q1(i);
    below_1 += first.col(i) * q1(i) + screws.jacobian.col(i) * q2(i);
    below += screws.jacobian.col(i) * q1(i);
  }
  joints.col(1) = q1;
  joints.col(2) = q2;
  joints.col(3) = screws.inverse * left;
  return out;
}

int SerialKinematics::all(const ToolPose& pose, Position6* out, int room) const noexcept {
  const Eigen::Isometry3d flange = flange_pose(cell_, pose);
  std::array<Position6, most_branches> branches;
  int count = 0;
  if (inverse_) {
    const InverseSolutions solutions = inverse_->solve(flange);
    for (; count < solutions.count; ++count) {
      const auto k = static_cast<std::size_t>(count);
      branches[k] = solutions.solution[k].position_rad;
    }
  } else {
    count = search(flange, branches.data());
  }
  // Turns 0, −1, +1 of each joint; branches without turns come first.
  int found = 0;
  for (int code = 0; code < 729; ++code) {
    Position6 turned;
    for (int i = 0, rest = code; i < 6; ++i, rest /= 3)
      turned(i) = units::revolution * (rest % 3 == 2 ? 1 : -(rest % 3));
    for (int k = 0; k < count && found < room; ++k) {
      const Position6 position = branches[static_cast<std::size_t>(k)] + turned;
      const bool inside = (position.array() >= limits_.min_position.array()).all() &&
                          (position.array() <= limits_.max_position.array()).all();
      if (inside) out[found++] = position;
    }
  }
  return found;
}

/// Branches of an arm without closed form: where Newton's steps lead from seeds spread over all joints.
int SerialKinematics::search(const Eigen::Isometry3d& flange, Position6* branches) const noexcept {
  // Roots of x⁷ = x + 1 and their powers spread points evenly in six dimensions.
  constexpr double root = 1.1127756842787055;
  int count = 0;
  for (int k = 0, last = 0; k < seeds && k - last < fruitless && count < most_branches; ++k) {
    Position6 at;
    double power = 1.0;
    for (double& angle : at) {
      power /= root;
      angle = units::revolution * (std::fmod(0.5 + power * (k + 1), 1.0) - 0.5);
    }
    const NewtonEnd end = newton(cell_.arm, flange, at, steps);
    if (!(end.error_m <= accepted_error && end.error_rad <= accepted_error)) continue;
    for (double& angle : at) angle = std::remainder(angle, units::revolution);
    bool known = false;
    for (int other = 0; other < count && !known; ++other) {
      Position6 apart = at - branches[other];
      for (double& angle : apart) angle = std::remainder(angle, units::revolution);
      known = apart.cwiseAbs().maxCoeff() < 1e-6;
    }
    if (known) continue;
    branches[count++] = at;
    last = k;
  }
  return count;
}

ToolPose SerialKinematics::forward(const Position6& position) const noexcept {
  Posture posture;
  posture.update(cell_.arm, position);
  return tool_pose(cell_, posture.flange);
}

double SerialKinematics::regularity(const Position6& position) const noexcept {
  Posture posture;
  posture.update(cell_.arm, position);
  Matrix6 jac;
  posture.jacobian(cell_.arm, posture.flange * tip_point(cell_), jac);
  jac.topRows<3>() /= options_.singularity.characteristic_length_m;
  // By the squares of the singular values: thrice as fast, and below 1e-8 of no interest.
  const Matrix6 gram = jac * jac.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> squares(gram, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(squares.eigenvalues()(0), 0.0) / squares.eigenvalues()(5));
}

Configuration SerialKinematics::configuration(const Position6& position) const noexcept {
  Configuration out;
  if (!inverse_ && !parallel_axes_) return out;
  Posture posture;
  posture.update(cell_.arm, position);
  if (!inverse_) return parallel_configuration(posture);
  // Of all ways to the flange's pose the one that the position is, whole turns apart.
  const InverseSolutions solutions = inverse_->solve(posture.flange, position);
  double least = HUGE_VAL;
  for (int k = 0; k < solutions.count; ++k) {
    const InverseSolution& way = solutions.solution[static_cast<std::size_t>(k)];
    double apart = 0.0;
    for (int i = 0; i < 6; ++i) {
      apart = std::max(apart, std::abs(std::remainder(way.position_rad(i) - position(i), units::revolution)));
    }
    if (!(apart < least)) continue;
    least = apart;
    out = {.known = true,
           .shoulder_back = way.shoulder_back,
           .elbow_down = way.elbow_down,
           .wrist_flipped = way.wrist_flipped,
           .shoulder_m = solutions.shoulder_m,
           .elbow_rad = way.elbow_rad,
           .wrist_rad = way.wrist_rad};
  }
  return out;
}

}  // namespace robomill::robot
