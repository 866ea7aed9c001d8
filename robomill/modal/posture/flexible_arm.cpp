#include "robomill/modal/posture/flexible_arm.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using Kind = ArmParameter::Kind;
constexpr double gravity_m_per_s2 = 9.81;
constexpr double compliance_unit_m_per_n = 1e-8;
/// A joint counts as unloaded below this share of its largest gravity torque.
constexpr double unloaded_share = 0.1;

/// Where joints and flange stand.
struct PlacedArm {
  std::vector<Eigen::Isometry3d> after;  ///< frame after each joint
  Eigen::Isometry3d flange = Eigen::Isometry3d::Identity();
};

Eigen::Vector3d across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d least = std::abs(axis.x()) <= std::abs(axis.y()) && std::abs(axis.x()) <= std::abs(axis.z())
                                    ? Eigen::Vector3d::UnitX()
                                : std::abs(axis.y()) <= std::abs(axis.z()) ? Eigen::Vector3d::UnitY()
                                                                           : Eigen::Vector3d::UnitZ();
  return axis.cross(least).normalized();
}

double unloaded(double load) {
  return std::exp(-(load / unloaded_share) * (load / unloaded_share));
}

}  // namespace

FlexibleArm::FlexibleArm(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                         const ArmStructure& structure, const std::vector<Tool>& tools)
    : cell_(cell), structure_(structure) {
  structure_.tool_modes = static_cast<int>(tools.size());
  const std::size_t n = cell.arm.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    const robot::Link& link = cell.arm.joints[i].link;
    if (link.mass_kg > 0.0) bodies_.push_back({.joint = i, .on_bracket = i + 1 == n && !payload, .link = link});
  }
  if (structure.bracket && !payload && n > 0 && cell.arm.joints[n - 1].link.mass_kg > 0.0) split_last_link();
  if (payload) bodies_.push_back({.joint = n - 1, .on_bracket = true, .link = *payload});
  largest_load_ = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(n));
  add_coordinates();
  add_coordinate_parameters(tools);
  add_mass_parameters(tools);
}

void FlexibleArm::split_last_link() {
  // What of it does not ride on the bracket is not told: a quarter, between joint and flange, is where to start.
  constexpr double inner_share = 0.25, inner_inertia_share = 0.1;
  Body& outer = bodies_.back();
  Body inner = outer;
  inner.on_bracket = false;
  inner.loose = outer.loose = true;
  inner.link.mass_kg *= inner_share;
  inner.link.center_m = 0.5 * cell_.arm.flange.translation();
  inner.link.inertia_kg_m2 *= inner_inertia_share;
  outer.link.mass_kg *= 1.0 - inner_share;
  bodies_.push_back(inner);
}

void FlexibleArm::add_coordinates() {
  const std::size_t n = cell_.arm.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d axis = cell_.arm.joints[i].axis.normalized();
    coordinates_.push_back({.kind = Coordinate::Kind::joint, .joint = i, .axis = axis});
    if (!structure_.bearings) continue;
    const Eigen::Vector3d first = across(axis);
    coordinates_.push_back({.kind = Coordinate::Kind::tilt, .joint = i, .axis = first});
    coordinates_.push_back({.kind = Coordinate::Kind::tilt, .joint = i, .axis = axis.cross(first)});
  }
  if (structure_.bracket) {
    for (int k = 0; k < 3; ++k) {
      coordinates_.push_back({.kind = Coordinate::Kind::bracket, .joint = n, .axis = Eigen::Vector3d::Unit(k)});
    }
  }
  for (int t = 0; t < structure_.tool_modes; ++t) {
    for (int k = 0; k < 2; ++k) {
      coordinates_.push_back({.kind = Coordinate::Kind::tool,
                              .joint = n,
                              .pair = static_cast<std::size_t>(t),
                              .axis = Eigen::Vector3d::Unit(k)});
    }
  }
}

void FlexibleArm::add(Kind kind, std::size_t index, double start, double deviation, double posture_deviation,
                      std::size_t axis) {
  parameters_.push_back({.kind = kind,
                         .index = index,
                         .axis = axis,
                         .start = start,
                         .deviation = deviation,
                         .posture_deviation = posture_deviation});
}

double FlexibleArm::first_stiffness(const Coordinate& at, const std::vector<Tool>& tools) const {
  constexpr double tilts_over_joint = 6.0;
  if (at.kind == Coordinate::Kind::tool) {
    const double rate = 2.0 * std::numbers::pi * tools[at.pair].frequency_hz;
    return tools[at.pair].mass_kg * rate * rate;
  }
  const double joint = cell_.arm.joints[std::min(at.joint, cell_.arm.joints.size() - 1)].stiffness;
  return at.kind == Coordinate::Kind::joint ? joint : tilts_over_joint * joint;
}

void FlexibleArm::add_coordinate_parameters(const std::vector<Tool>& tools) {
  // What a coordinate moves in the middle of its range decides its first guess of damping.
  constexpr double first_damping_ratio = 0.02;
  constexpr double stiffness_varies = 0.06, damping_varies = 0.15;
  const System plain = at(Eigen::VectorXd::Constant(cell_.arm.size(), 0.5), {});
  for (std::size_t c = 0; c < coordinates_.size(); ++c) {
    const Coordinate& at = coordinates_[c];
    const bool tool = at.kind == Coordinate::Kind::tool;
    const Eigen::Index row = static_cast<Eigen::Index>(c);
    const double mass = tool ? tools[at.pair].mass_kg : plain.mass(row, row);
    const double stiffness = first_stiffness(at, tools);
    double damping = 2.0 * first_damping_ratio * std::sqrt(stiffness * std::max(mass, 1e-9));
    switch (at.kind) {
      case Coordinate::Kind::joint:
        if (cell_.arm.joints[at.joint].damping > 0.0) damping = cell_.arm.joints[at.joint].damping;
        add(Kind::joint_stiffness, c, std::log(stiffness), 0.4, stiffness_varies);
        add(Kind::joint_damping, c, std::log(damping), 1.0, damping_varies);
        if (!structure_.load) break;
        add(Kind::joint_load, at.joint, 0.0, 0.15);
        add(Kind::joint_unloaded, at.joint, 0.0, 0.1);
        break;
      case Coordinate::Kind::tilt:
        add(Kind::tilt_stiffness, c, std::log(stiffness), 1.0);
        add(Kind::tilt_damping, c, std::log(damping), 1.0);
        break;
      case Coordinate::Kind::bracket:
        add(Kind::bracket_stiffness, c, std::log(stiffness), 1.5);
        add(Kind::bracket_damping, c, std::log(damping), 1.0);
        break;
      case Coordinate::Kind::tool:
        add(Kind::tool_stiffness, c, std::log(stiffness), 0.5);
        add(Kind::tool_damping, c, std::log(damping), 1.0);
        break;
    }
  }
}

void FlexibleArm::add_mass_parameters(const std::vector<Tool>& tools) {
  for (std::size_t t = 0; t < tools.size(); ++t) add(Kind::tool_mass, t, std::log(tools[t].mass_kg), 0.7);
  for (std::size_t k = 0; k < 3; ++k) add(Kind::compliance, k, 0.0, 3.0);
  for (std::size_t i = 0; i < cell_.arm.joints.size(); ++i) {
    const double rotor = cell_.arm.joints[i].rotor_inertia;
    if (rotor > 0.0) add(Kind::rotor_inertia, i, std::log(rotor), 0.2);
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const double known = bodies_[b].loose ? 0.7 : 0.2;
    add(Kind::body_mass, b, 0.0, known);
    add(Kind::body_inertia, b, 0.0, known);
    const double arm = bodies_[b].link.center_m.norm();
    for (std::size_t k = 0; k < 3; ++k) add(Kind::body_center, b, 0.0, 0.02 + 0.5 * known * arm, 0.0, k);
  }
}

Eigen::VectorXd FlexibleArm::start() const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(parameters_.size()));
  for (std::size_t i = 0; i < parameters_.size(); ++i) out(static_cast<Eigen::Index>(i)) = parameters_[i].start;
  return out;
}

Eigen::VectorXd FlexibleArm::start_near(const FlexibleArm& other, const Eigen::VectorXd& values) const {
  // Coordinates of a kind stand in one row; those of the tool begin later where there is a bracket.
  const auto first = [](const FlexibleArm& arm, Kind kind) {
    std::size_t least = SIZE_MAX;
    for (const ArmParameter& parameter : arm.parameters_) {
      if (parameter.kind == kind) least = std::min(least, parameter.index);
    }
    return least;
  };
  Eigen::VectorXd out = start();
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ArmParameter& own = parameters_[p];
    for (std::size_t q = 0; q < other.parameters_.size(); ++q) {
      const ArmParameter& its = other.parameters_[q];
      if (its.kind != own.kind || its.axis != own.axis) continue;
      if (its.index - first(other, its.kind) != own.index - first(*this, own.kind)) continue;
      out(static_cast<Eigen::Index>(p)) = values(static_cast<Eigen::Index>(q));
    }
  }
  return out;
}

namespace {

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

Eigen::Index FlexibleArm::coordinate_of(const ArmParameter& parameter) const {
  switch (parameter.kind) {
    case Kind::joint_load:
    case Kind::joint_unloaded:
    case Kind::rotor_inertia:
      // Each joint's coordinates follow those of the one before.
      return static_cast<Eigen::Index>(parameter.index) * (structure_.bearings ? 3 : 1);
    case Kind::joint_stiffness:
    case Kind::joint_damping:
    case Kind::tilt_stiffness:
    case Kind::tilt_damping:
    case Kind::bracket_stiffness:
    case Kind::bracket_damping:
    case Kind::tool_stiffness:
    case Kind::tool_damping:
      return static_cast<Eigen::Index>(parameter.index);
    default:
      return -1;
  }
}

/// What the parameters say of bodies.
struct FlexibleArm::Values {
  std::vector<double> mass_scale, inertia_scale;
  std::vector<Eigen::Vector3d> shift_m;
};

FlexibleArm::Values FlexibleArm::values_of(const Eigen::VectorXd& parameters, System& out) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  Values values{.mass_scale = std::vector<double>(bodies_.size(), 1.0),
                .inertia_scale = std::vector<double>(bodies_.size(), 1.0),
                .shift_m = std::vector<Eigen::Vector3d>(bodies_.size(), Eigen::Vector3d::Zero())};
  out.stiffness = out.damping = out.rotor = Eigen::VectorXd::Zero(n);
  out.tool_mass_kg.assign(static_cast<std::size_t>(structure_.tool_modes), 0.0);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    if (at.kind == Coordinate::Kind::joint) out.rotor(c) = cell_.arm.joints[at.joint].rotor_inertia;
  }
  if (parameters.size() == 0) return values;
  Eigen::VectorXd log_factor = Eigen::VectorXd::Zero(n);
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ArmParameter& parameter = parameters_[p];
    const double value = parameters(static_cast<Eigen::Index>(p));
    const Eigen::Index c = coordinate_of(parameter);
    const Eigen::Index index = static_cast<Eigen::Index>(parameter.index);
    switch (parameter.kind) {
      case Kind::joint_stiffness:
      case Kind::tilt_stiffness:
      case Kind::bracket_stiffness:
      case Kind::tool_stiffness:
        out.stiffness(c) = std::exp(value);
        break;
      case Kind::joint_damping:
      case Kind::tilt_damping:
      case Kind::bracket_damping:
      case Kind::tool_damping:
        out.damping(c) = std::exp(value);
        break;
      case Kind::joint_load:
        log_factor(c) += value * out.load(index);
        break;
      case Kind::joint_unloaded:
        log_factor(c) += value * unloaded(out.load(index));
        break;
      case Kind::tool_mass:
        out.tool_mass_kg[parameter.index] = std::exp(value);
        break;
      case Kind::compliance:
        out.compliance(index) = value * compliance_unit_m_per_n;
        break;
      case Kind::rotor_inertia:
        out.rotor(c) = std::exp(value);
        break;
      case Kind::body_mass:
        values.mass_scale[parameter.index] = std::exp(value);
        break;
      case Kind::body_inertia:
        values.inertia_scale[parameter.index] = std::exp(value);
        break;
      case Kind::body_center:
        values.shift_m[parameter.index](static_cast<Eigen::Index>(parameter.axis)) = value;
        break;
    }
  }
  out.stiffness = out.stiffness.array() * log_factor.array().exp();
  return values;
}

FlexibleArm::System FlexibleArm::at(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  std::vector<Eigen::Isometry3d> before;
  const PlacedArm placed = place_joints(cell_, joints, before);
  System out;
  out.flange_axes = placed.flange.linear();
  out.load = (gravity_torque(joints).array() / largest_load_.array()).min(2.0);
  Eigen::Matrix3Xd axis(3, n), origin(3, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    const Eigen::Isometry3d& frame = at.joint >= before.size() ? placed.flange : before[at.joint];
    axis.col(c) = frame.linear() * at.axis;
    origin.col(c) = frame.translation();
  }
  const auto velocity = [&](Eigen::Index c, const Eigen::Vector3d& point) -> Eigen::Vector3d {
    if (translates(coordinates_[static_cast<std::size_t>(c)])) return axis.col(c);
    return Eigen::Vector3d(axis.col(c)).cross(point - origin.col(c));
  };
  const Eigen::Vector3d tip = placed.flange * Eigen::Vector3d(0.0, 0.0, cell_.tool_length_m);
  out.input.resize(n, 3);
  for (Eigen::Index c = 0; c < n; ++c) out.input.row(c) = velocity(c, tip).transpose();
  const Values values = values_of(parameters, out);
  out.mass = Eigen::MatrixXd(out.rotor.asDiagonal());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Eigen::Isometry3d& frame = placed.after[body.joint];
    const Eigen::Vector3d center = frame * (body.link.center_m + values.shift_m[b]);
    BodyMotion motion{.mass_kg = values.mass_scale[b] * body.link.mass_kg,
                      .inertia = values.mass_scale[b] * values.inertia_scale[b] * frame.linear() *
                                 body.link.inertia_kg_m2 * frame.linear().transpose(),
                      .axes = frame.linear(),
                      .linear = Eigen::Matrix3Xd::Zero(3, n),
                      .turning = Eigen::Matrix3Xd::Zero(3, n)};
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      const bool moved = at.kind == Coordinate::Kind::bracket ? body.on_bracket
                         : at.kind == Coordinate::Kind::tool  ? false
                                                              : at.joint <= body.joint;
      if (!moved) continue;
      motion.linear.col(c) = velocity(c, center);
      if (!translates(at)) motion.turning.col(c) = axis.col(c);
    }
    out.mass += motion.mass_kg * (motion.linear.transpose() * motion.linear) +
                motion.turning.transpose() * motion.inertia * motion.turning;
    out.bodies.push_back(std::move(motion));
  }
  for (std::size_t t = 0; t < out.tool_mass_kg.size(); ++t) {
    Eigen::MatrixXd moved = out.input;
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      if (at.kind == Coordinate::Kind::tool && at.pair != t) moved.row(c).setZero();
    }
    out.mass += out.tool_mass_kg[t] * (moved * moved.transpose());
    out.tool_input.push_back(std::move(moved));
  }
  return out;
}

std::pair<double, double> FlexibleArm::diagonal_change(const System& system, const ArmParameter& parameter) const {
  const Eigen::Index c = coordinate_of(parameter);
  const auto load = [&] { return system.load(static_cast<Eigen::Index>(parameter.index)); };
  switch (parameter.kind) {
    case Kind::joint_stiffness:
    case Kind::tilt_stiffness:
    case Kind::bracket_stiffness:
    case Kind::tool_stiffness:
      return {system.stiffness(c), 0.0};
    case Kind::joint_load:
      return {system.stiffness(c) * load(), 0.0};
    case Kind::joint_unloaded:
      return {system.stiffness(c) * unloaded(load()), 0.0};
    case Kind::joint_damping:
    case Kind::tilt_damping:
    case Kind::bracket_damping:
    case Kind::tool_damping:
      return {0.0, system.damping(c)};
    default:
      return {0.0, 0.0};
  }
}

namespace {

/// The velocity of a centre that moves out by a unit along an axis of its link, from the angular one.
template <class Matrix>
Matrix swung(const FlexibleArm::BodyMotion& body, std::size_t axis, const Matrix& turned) {
  const Eigen::Vector3d out = body.axes.col(static_cast<Eigen::Index>(axis));
  Eigen::Matrix3d cross;
  cross << 0.0, out.z(), -out.y(), -out.z(), 0.0, out.x(), out.y(), -out.x(), 0.0;
  return cross * turned;
}

}  // namespace

Eigen::MatrixXcd FlexibleArm::mass_change(const System& system, const ArmParameter& parameter,
                                          const Eigen::MatrixXcd& x) const {
  if (parameter.kind == Kind::rotor_inertia) {
    const Eigen::Index c = coordinate_of(parameter);
    Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(x.rows(), x.cols());
    out.row(c) = system.rotor(c) * x.row(c);
    return out;
  }
  if (parameter.kind == Kind::tool_mass) {
    const Eigen::MatrixXd& input = system.tool_input[parameter.index];
    return system.tool_mass_kg[parameter.index] * (input * (input.transpose() * x));
  }
  const BodyMotion& body = system.bodies[parameter.index];
  const Eigen::MatrixXcd turned = body.turning * x, moved = body.linear * x;
  if (parameter.kind == Kind::body_center) {
    const Eigen::MatrixXcd out = swung(body, parameter.axis, turned);
    const Eigen::Matrix3Xd arm = swung(body, parameter.axis, body.turning);
    return body.mass_kg * (arm.transpose() * moved + body.linear.transpose() * out);
  }
  Eigen::MatrixXcd out = body.turning.transpose() * (body.inertia * turned);
  if (parameter.kind == Kind::body_mass) out += body.mass_kg * (body.linear.transpose() * moved);
  return out;
}

namespace {

Eigen::Matrix3cd in_base(const FlexibleArm::System& system) {
  return (system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose()).cast<Complex>();
}

Eigen::MatrixXcd dynamic_stiffness(const FlexibleArm::System& system, Complex s) {
  Eigen::MatrixXcd z = s * s * system.mass;
  z.diagonal() += system.stiffness + s * system.damping;
  return z;
}

}  // namespace

Eigen::Matrix3cd FlexibleArm::receptance(const System& system, Complex s) {
  const Eigen::MatrixXcd moved = dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  return system.input.transpose() * moved + in_base(system);
}

void FlexibleArm::receptance(const System& system, Complex s, Eigen::Matrix3cd& value,
                             Eigen::Ref<Eigen::Matrix<Complex, 9, Eigen::Dynamic>> derivative) const {
  const Eigen::Matrix<Complex, Eigen::Dynamic, 3> g =
      dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  value = system.input.transpose() * g + in_base(system);
  // ∂H = −gᵀ (∂K + s ∂C + s² ∂M) g; of a body from the motion of its centre and its turning, 3 x 3 each.
  std::vector<Eigen::Matrix3cd> moved, turned;
  for (const BodyMotion& body : system.bodies) {
    moved.emplace_back(body.linear * g);
    turned.emplace_back(body.turning * g);
  }
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ArmParameter& parameter = parameters_[p];
    const std::size_t index = parameter.index;
    Eigen::Matrix3cd change;
    if (parameter.kind == Kind::compliance) {
      const Eigen::Vector3d axis = system.flange_axes.col(static_cast<Eigen::Index>(index));
      change = (compliance_unit_m_per_n * axis * axis.transpose()).cast<Complex>();
    } else if (parameter.kind == Kind::body_center) {
      const Eigen::Matrix3cd half = system.bodies[index].mass_kg *
                                    swung(system.bodies[index], parameter.axis, turned[index]).transpose() *
                                    moved[index];
      change = -s * s * (half + half.transpose());
    } else if (parameter.kind == Kind::body_mass || parameter.kind == Kind::body_inertia) {
      const BodyMotion& body = system.bodies[index];
      change = turned[index].transpose() * body.inertia * turned[index];
      if (parameter.kind == Kind::body_mass) change += body.mass_kg * moved[index].transpose() * moved[index];
      change *= -s * s;
    } else if (parameter.kind == Kind::tool_mass) {
      const Eigen::Matrix3cd at = system.tool_input[index].transpose() * g;
      change = -s * s * system.tool_mass_kg[index] * at.transpose() * at;
    } else {
      const Eigen::Index c = coordinate_of(parameter);
      const auto [stiffness, damping] = diagonal_change(system, parameter);
      const double rotor = parameter.kind == Kind::rotor_inertia ? system.rotor(c) : 0.0;
      change = -(stiffness + s * damping + s * s * rotor) * (g.row(c).transpose() * g.row(c));
    }
    derivative.col(static_cast<Eigen::Index>(p)) = Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(change.data());
  }
}

}  // namespace robomill::modal::detail
