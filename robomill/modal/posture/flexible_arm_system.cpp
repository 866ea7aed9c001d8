#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "robomill/modal/posture/flexible_arm.hpp"
#include "robomill/modal/posture/symmetric_exponential.hpp"

namespace robomill::modal::detail {
namespace {

using Kind = ArmParameter::Kind;
constexpr double gravity_m_per_s2 = 9.81;
/// A joint counts as unloaded below this share of its largest gravity torque.
constexpr double unloaded_share = 0.1;

double unloaded(double load) {
  return std::exp(-(load / unloaded_share) * (load / unloaded_share));
}

/// Where joints and flange stand.
struct PlacedArm {
  std::vector<Eigen::Isometry3d> after;  ///< frame after each joint
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
};

/// Frames of joints and flange.
PlacedArm place_joints(const robot::Cell& cell, const Eigen::VectorXd& joints, std::vector<Eigen::Isometry3d>& before) {
  PlacedArm out;
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < cell.arm.joints.size(); ++i) {
    const robot::Joint& joint = cell.arm.joints[i];
    const double q = joints(static_cast<Eigen::Index>(i));
    at = at * joint.before;
    before.push_back(at);
    if (joint.prismatic) {
      at.translate(q * joint.axis);
    } else {
      at.rotate(Eigen::AngleAxisd(q, joint.axis.normalized()));
    }
    out.after.push_back(at);
  }
  out.flange = at * cell.arm.flange;
  return out;
}

}  // namespace

Eigen::VectorXd FlexibleArm::gravity_torque(const Eigen::VectorXd& joints) const {
  std::vector<Eigen::Isometry3d> before;
  const PlacedArm placed = place_joints(cell_, joints, before);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(joints.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector3d axis = before[i].linear() * cell_.arm.joints[i].axis.normalized();
    for (const Body& body : bodies_) {
      if (body.joint < i) continue;
      const Eigen::Vector3d center = placed.after[body.joint] * body.link.center_m;
      const Eigen::Vector3d weight(0.0, 0.0, -body.link.mass_kg * gravity_m_per_s2);
      torque(static_cast<Eigen::Index>(i)) +=
          cell_.arm.joints[i].prismatic ? axis.dot(weight) : axis.dot((center - before[i].translation()).cross(weight));
    }
  }
  return torque.cwiseAbs();
}

void FlexibleArm::scale_loads(const std::vector<Eigen::VectorXd>& postures) {
  largest_load_.setConstant(1e-9);
  for (const Eigen::VectorXd& joints : postures) largest_load_ = largest_load_.cwiseMax(gravity_torque(joints));
}

bool FlexibleArm::translates(const Coordinate& at) const {
  return at.kind == Coordinate::Kind::tool ||
         (at.kind == Coordinate::Kind::joint && cell_.arm.joints[at.joint].prismatic);
}

struct FlexibleArm::Placed {
  PlacedArm arm;
  Eigen::Matrix3Xd axis, origin_m;  // 3 x n
  std::vector<char> translates;

  [[nodiscard]] Eigen::Vector3d velocity(Eigen::Index c, const Eigen::Vector3d& point_m) const {
    if (translates[static_cast<std::size_t>(c)] != 0) return axis.col(c);
    return Eigen::Vector3d(axis.col(c)).cross(point_m - origin_m.col(c));
  }
};

FlexibleArm::Placed FlexibleArm::place(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters) const {
  Eigen::Vector3d pivot_m = Eigen::Vector3d::Zero();
  for (Eigen::Index p = 0; p < parameters.size(); ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::bracket_pivot) pivot_m(static_cast<Eigen::Index>(parameter.index)) = parameters(p);
  }
  std::vector<Eigen::Isometry3d> before;
  Placed out{.arm = place_joints(cell_, joints, before), .axis = {}, .origin_m = {}, .translates = {}};
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  out.axis.resize(3, n);
  out.origin_m.resize(3, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    const Eigen::Isometry3d& frame = at.joint >= before.size() ? out.arm.flange : before[at.joint];
    out.axis.col(c) = frame.linear() * at.axis;
    out.origin_m.col(c) = at.kind == Coordinate::Kind::bracket ? frame * pivot_m : frame.translation();
    out.translates.push_back(translates(at) ? 1 : 0);
  }
  return out;
}

Eigen::Index FlexibleArm::joint_row(std::size_t joint) const {
  // Each joint's coordinates follow those of the one before.
  return static_cast<Eigen::Index>(joint) * (structure_.bearings ? 3 : 1);
}

/// A joint's stiffness with its load's share of it, and what its parameters change.
void FlexibleArm::set_joint_springs(const Eigen::VectorXd& parameters, System& out) const {
  const auto index = [&](std::size_t p) { return static_cast<Eigen::Index>(parameters_[p].index); };
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ArmParameter& parameter = parameters_[p];
    if (parameter.kind != Kind::joint_load && parameter.kind != Kind::joint_unloaded) continue;
    const double load = out.load(index(p));
    const double by = parameter.kind == Kind::joint_load ? load : unloaded(load);
    const Eigen::Index row = joint_row(parameter.index);
    out.stiffness(row, row) *= std::exp(parameters(static_cast<Eigen::Index>(p)) * by);
    out.springs[p] = {.first = row, .count = 1};
    out.springs[p].stiffness(0, 0) = by;
  }
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const Eigen::Index row = out.springs[p].first;
    const Kind kind = parameters_[p].kind;
    if (kind == Kind::joint_load || kind == Kind::joint_unloaded) {
      out.springs[p].stiffness(0, 0) *= out.stiffness(row, row);
    } else if (kind == Kind::joint_stiffness) {
      out.springs[p].stiffness(0, 0) = out.stiffness(row, row);
    }
  }
}

/// K and C are exponentials, group by group: positive definite whatever the parameters.
void FlexibleArm::set_springs(const Eigen::VectorXd& parameters, System& out) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  out.stiffness = out.damping = Eigen::MatrixXd::Zero(n, n);
  out.springs.resize(parameters_.size());
  struct Entry {
    std::size_t parameter;
    bool stiffness;
    Eigen::Index row, column;
  };
  for (const Group& group : groups_) {
    const auto first = static_cast<Eigen::Index>(group.first), count = static_cast<Eigen::Index>(group.count);
    Eigen::MatrixXd of_stiffness = Eigen::MatrixXd::Zero(count, count), of_damping = of_stiffness;
    std::vector<Entry> entries;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const ArmParameter& parameter = parameters_[p];
      const bool stiffness = is_stiffness(parameter.kind);
      if (!stiffness && !is_damping(parameter.kind)) continue;
      if (parameter.index < group.first || parameter.index >= group.first + group.count) continue;
      const Eigen::Index row = static_cast<Eigen::Index>(parameter.index - group.first);
      const Eigen::Index column = row + static_cast<Eigen::Index>(parameter.axis);
      Eigen::MatrixXd& logarithm = stiffness ? of_stiffness : of_damping;
      logarithm(row, column) = logarithm(column, row) = parameters(static_cast<Eigen::Index>(p));
      entries.push_back({.parameter = p, .stiffness = stiffness, .row = row, .column = column});
    }
    const SymmetricExponential k(of_stiffness), c(of_damping);
    out.stiffness.block(first, first, count, count) = k.value();
    out.damping.block(first, first, count, count) = c.value();
    for (const Entry& entry : entries) {
      SpringChange& change = out.springs[entry.parameter];
      change.first = first;
      change.count = count;
      Eigen::Matrix3d& side = entry.stiffness ? change.stiffness : change.damping;
      side.topLeftCorner(count, count) = (entry.stiffness ? k : c).derivative(entry.row, entry.column);
    }
  }
  set_joint_springs(parameters, out);
}

void FlexibleArm::add_bodies(const Placed& placed, const Eigen::VectorXd& parameters, System& out) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  std::vector<double> mass(bodies_.size(), 1.0), inertia(bodies_.size(), 1.0);
  std::vector<Eigen::Vector3d> shift_m(bodies_.size(), Eigen::Vector3d::Zero());
  for (Eigen::Index p = 0; p < parameters.size(); ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::body_mass) mass[parameter.index] = std::exp(parameters(p));
    if (parameter.kind == Kind::body_inertia) inertia[parameter.index] = std::exp(parameters(p));
    if (parameter.kind == Kind::body_center) {
      shift_m[parameter.index](static_cast<Eigen::Index>(parameter.axis)) = parameters(p);
    }
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Eigen::Isometry3d& frame = placed.arm.after[body.joint];
    const Eigen::Vector3d center = frame * (body.link.center_m + shift_m[b]);
    BodyMotion motion{
        .mass_kg = mass[b] * body.link.mass_kg,
        .inertia = mass[b] * inertia[b] * frame.linear() * body.link.inertia_kg_m2 * frame.linear().transpose(),
        .axes = frame.linear(),
        .linear = Eigen::Matrix3Xd::Zero(3, n),
        .turning = Eigen::Matrix3Xd::Zero(3, n),
        .on_bracket = body.on_bracket};
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      const bool moved = at.kind == Coordinate::Kind::bracket ? body.on_bracket
                         : at.kind == Coordinate::Kind::tool  ? false
                                                              : at.joint <= body.joint;
      if (!moved) continue;
      motion.linear.col(c) = placed.velocity(c, center);
      if (!translates(at)) motion.turning.col(c) = placed.axis.col(c);
    }
    out.mass += motion.mass_kg * (motion.linear.transpose() * motion.linear) +
                motion.turning.transpose() * motion.inertia * motion.turning;
    out.bodies.push_back(std::move(motion));
  }
}

void FlexibleArm::add_tools(const Eigen::VectorXd& parameters, System& out) const {
  out.tools.resize(static_cast<std::size_t>(structure_.tool_modes));
  for (Eigen::Index p = 0; p < parameters.size(); ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::tool_mass) out.tools[parameter.index].mass_kg = std::exp(parameters(p));
  }
  for (std::size_t t = 0; t < out.tools.size(); ++t) {
    ToolMotion& tool = out.tools[t];
    tool.input = out.input;
    for (Eigen::Index c = 0; c < out.input.rows(); ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      if (at.kind == Coordinate::Kind::tool && at.pair > t) tool.input.row(c).setZero();
    }
    out.mass += tool.mass_kg * (tool.input * tool.input.transpose());
  }
}

FlexibleArm::System FlexibleArm::at(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  const Placed placed = place(joints, parameters);
  System out;
  out.flange_axes = placed.arm.flange.linear();
  out.load = (gravity_torque(joints).array() / largest_load_.array()).min(2.0);
  const Eigen::Vector3d tip = placed.arm.flange * Eigen::Vector3d(0.0, 0.0, cell_.tool_length_m);
  out.input.resize(n, 3);
  for (Eigen::Index c = 0; c < n; ++c) out.input.row(c) = placed.velocity(c, tip).transpose();
  out.rotor = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < cell_.arm.joints.size(); ++i) out.rotor(joint_row(i)) = cell_.arm.joints[i].rotor_inertia;
  for (Eigen::Index p = 0; p < parameters.size(); ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::rotor_inertia) out.rotor(joint_row(parameter.index)) = std::exp(parameters(p));
    if (parameter.kind == Kind::compliance) {
      out.compliance(static_cast<Eigen::Index>(parameter.index)) = parameters(p) * compliance_unit_m_per_n;
    }
  }
  out.mass = Eigen::MatrixXd(out.rotor.asDiagonal());
  add_bodies(placed, parameters, out);
  add_tools(parameters, out);
  if (parameters.size() > 0) set_springs(parameters, out);
  return out;
}

}  // namespace robomill::modal::detail
