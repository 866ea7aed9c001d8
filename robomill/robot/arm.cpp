#include "robomill/robot/arm.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::robot {
namespace {

constexpr double unit_tolerance = 1e-6;
constexpr double no_limit = 1e300;

void require_isometry(const std::string& field, const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite()) throw InvalidInput(field, "must be finite");
  const Eigen::Matrix3d product = pose.linear().transpose() * pose.linear();
  if (!product.isIdentity(unit_tolerance) || pose.linear().determinant() < 0.0) {
    throw InvalidInput(field, "must hold a rotation, R^T R = 1 and det R = 1");
  }
}

void require_range(const Joint& joint) {
  if (std::isnan(joint.min_position) || std::isnan(joint.max_position)) {
    throw InvalidInput("min_position", "must be a number");
  }
  if (!(joint.min_position < joint.max_position)) {
    throw InvalidInput("min_position", joint.min_position, joint.prismatic ? "m" : "rad", "must be below max_position",
                       "Are the two lists exchanged?");
  }
}

void validate_link(const Link& link) {
  require_non_negative("link.mass_kg", link.mass_kg, "kg");
  if (!link.center_m.allFinite()) throw InvalidInput("link.center_m", "must be finite");
  const Eigen::Matrix3d& inertia = link.inertia_kg_m2;
  if (!inertia.allFinite()) throw InvalidInput("link.inertia_kg_m2", "must be finite");
  const double size = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > unit_tolerance * size) {
    throw InvalidInput("link.inertia_kg_m2", "must be symmetric");
  }
  // Principal minors of a positive semi-definite matrix, with room for rounding.
  const double minor_xy = inertia(0, 0) * inertia(1, 1) - inertia(0, 1) * inertia(1, 0);
  const bool semi_definite = inertia.diagonal().minCoeff() >= 0.0 && minor_xy >= -unit_tolerance * size * size &&
                             inertia.determinant() >= -unit_tolerance * size * size * size;
  if (!semi_definite) {
    throw InvalidInput("link.inertia_kg_m2", "must be positive semi-definite",
                       "It is about the centre of mass, not about the joint");
  }
}

void validate_joint(const Joint& joint) {
  require_isometry("before", joint.before);
  if (!joint.axis.allFinite() || std::abs(joint.axis.norm() - 1.0) > unit_tolerance) {
    throw InvalidInput("axis", "must be a unit vector");
  }
  require_range(joint);
  const bool prismatic = joint.prismatic;
  require_non_negative("max_velocity", joint.max_velocity, prismatic ? "m/s" : "rad/s");
  require_non_negative("max_acceleration", joint.max_acceleration, prismatic ? "m/s^2" : "rad/s^2");
  require_non_negative("max_jerk", joint.max_jerk, prismatic ? "m/s^3" : "rad/s^3");
  require_non_negative("stiffness", joint.stiffness, prismatic ? "N/m" : "N m/rad");
  require_non_negative("damping", joint.damping, prismatic ? "N s/m" : "N m s/rad");
  require_non_negative("rotor_inertia", joint.rotor_inertia, prismatic ? "kg" : "kg m^2");
  require_non_negative("max_torque", joint.max_torque, prismatic ? "N" : "N m");
  validate_link(joint.link);
}

void require_length(const Arm& arm, Eigen::Index length) {
  if (arm.size() > max_joints) {
    throw InvalidInput("joints", static_cast<double>(arm.size()), "joints",
                       "must be at most " + std::to_string(max_joints));
  }
  if (length == arm.size()) return;
  throw InvalidInput("position", static_cast<double>(length), "joints",
                     "must have one value a joint, " + std::to_string(arm.size()));
}

/// Rotates by `angle_rad` about the unit vector `axis`, by Rodrigues' formula.
Eigen::Matrix3d rotation(const Eigen::Vector3d& axis, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const Eigen::Vector3d sa = s * axis, va = (1.0 - c) * axis;
  Eigen::Matrix3d out = va * axis.transpose();
  out.diagonal().array() += c;
  out(0, 1) -= sa.z();
  out(1, 0) += sa.z();
  out(0, 2) += sa.y();
  out(2, 0) -= sa.y();
  out(1, 2) -= sa.x();
  out(2, 1) += sa.x();
  return out;
}

/// Takes the frame below a joint to the frame after it.
void step(const Joint& joint, double position, Eigen::Isometry3d& pose) {
  pose.translation() += pose.linear() * joint.before.translation();
  pose.linear() = (pose.linear() * joint.before.linear()).eval();
  if (joint.prismatic) {
    pose.translation() += position * (pose.linear() * joint.axis);
  } else {
    pose.linear() = (pose.linear() * rotation(joint.axis, position)).eval();
  }
}

}  // namespace

void Arm::validate() const {
  if (joints.empty()) throw InvalidInput("joints", "must hold at least one joint");
  require_length(*this, size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    try {
      validate_joint(joints[i]);
    } catch (const InvalidInput& error) {
      throw within("joints[" + std::to_string(i + 1) + "].", error);
    }
  }
  require_isometry("flange", flange);
}

Eigen::Isometry3d dh_link(const DhRow& row) {
  return Eigen::Translation3d(row.a_m, 0.0, row.d_m) * Eigen::AngleAxisd(row.alpha_rad, Eigen::Vector3d::UnitX());
}

Arm arm_from_dh(const std::vector<DhRow>& rows, const Eigen::Isometry3d& base) {
  Arm arm;
  arm.joints.reserve(rows.size());
  Eigen::Isometry3d rest = base;  // of the row before, behind its joint
  for (const DhRow& row : rows) {
    Joint joint;
    joint.name = "joint_" + std::to_string(arm.joints.size() + 1);
    joint.before = rest * Eigen::AngleAxisd(row.theta_offset_rad, Eigen::Vector3d::UnitZ());
    arm.joints.push_back(joint);
    rest = dh_link(row);
  }
  arm.flange = rest;
  arm.validate();
  return arm;
}

Eigen::Isometry3d forward(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position) {
  require_length(arm, position.size());
  if (!position.allFinite()) throw InvalidInput("position", "must be finite");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) step(arm.joints[i], position(static_cast<Eigen::Index>(i)), pose);
  return pose * arm.flange;
}

void Posture::update(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position) {
  axis.resize(3, arm.size());
  origin_m.resize(3, arm.size());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    step(arm.joints[i], position(column), pose);
    axis.col(column).noalias() = pose.linear() * arm.joints[i].axis;
    origin_m.col(column) = pose.translation();
  }
  flange = pose * arm.flange;
}

void Posture::jacobian(const Arm& arm, const Eigen::Vector3d& at_m,
                       Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const {
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d along = axis.col(column);
    if (arm.joints[i].prismatic) {
      out.col(column) << along, Eigen::Vector3d::Zero();
    } else {
      const Eigen::Vector3d lever = at_m - origin_m.col(column);
      out.col(column) << along.cross(lever), along;
    }
  }
}

Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                                  const Eigen::Vector3d& point_m) {
  require_length(arm, position.size());
  if (!position.allFinite()) throw InvalidInput("position", "must be finite");
  Posture posture;
  posture.update(arm, position);
  Eigen::Matrix<double, 6, Eigen::Dynamic> out(6, arm.size());
  posture.jacobian(arm, posture.flange * point_m, out);
  return out;
}

LimitCheck within_limits(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position) {
  require_length(arm, position.size());
  LimitCheck out;
  double least = 0.0;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const Joint& joint = arm.joints[i];
    const auto index = static_cast<Eigen::Index>(i);
    const double distance = std::min(position(index) - joint.min_position, joint.max_position - position(index));
    if (!(distance >= 0.0)) out.inside = false;
    // A joint without an upper or a lower limit has no range; half a turn stands for it.
    const double share = distance / std::min(0.5 * joint.max_position - 0.5 * joint.min_position, std::numbers::pi);
    if (joint.min_position <= -no_limit && joint.max_position >= no_limit) continue;
    if (out.joint >= 0 && !(share < least)) continue;
    least = share;
    out.joint = index;
    out.distance = distance;
  }
  return out;
}

void Cell::validate() const {
  try {
    arm.validate();
  } catch (const InvalidInput& error) {
    throw within("arm.", error);
  }
  require_isometry("workpiece", workpiece);
  require_non_negative("tool_length_m", tool_length_m, "m");
}

}  // namespace robomill::robot
