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

/// Where every coordinate and body stands.
struct Placed {
  Eigen::Matrix3Xd axis, origin;         ///< of each coordinate, in B
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
  if (payload) bodies_.push_back({.joint = n - 1, .on_bracket = true, .link = *payload});
  largest_load_ = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(n));
  add_coordinates();
  add_parameters(tools);
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

void FlexibleArm::add_parameters(const std::vector<Tool>& tools) {
  // What a coordinate moves at the middle of its range decides its first guess of damping: 2 % of critical.
  const Eigen::Index n = cell_.arm.size();
  Eigen::VectorXd middle = Eigen::VectorXd::Constant(n, 0.5);
  Eigen::VectorXd none = Eigen::VectorXd::Zero(0);
  constexpr double first_damping = 0.02;
  constexpr double tilts_over_joint = 6.0;
  std::vector<double> stiffness(coordinates_.size());
  for (std::size_t c = 0; c < coordinates_.size(); ++c) {
    const Coordinate& at = coordinates_[c];
    const auto joint = [&](std::size_t i) {
      return cell_.arm.joints[std::min(i, cell_.arm.joints.size() - 1)].stiffness;
    };
    switch (at.kind) {
      case Coordinate::Kind::joint:
        stiffness[c] = joint(at.joint);
        break;
      case Coordinate::Kind::tilt:
        stiffness[c] = tilts_over_joint * joint(at.joint);
        break;
      case Coordinate::Kind::bracket:
        stiffness[c] = tilts_over_joint * joint(at.joint);
        break;
      case Coordinate::Kind::tool: {
        const double rate = 2.0 * std::numbers::pi * tools[at.pair].frequency_hz;
        stiffness[c] = tools[at.pair].mass_kg * rate * rate;
        break;
      }
    }
  }
  const System plain = at(middle, none, false);
  for (std::size_t c = 0; c < coordinates_.size(); ++c) {
    const Coordinate& at = coordinates_[c];
    const bool tool = at.kind == Coordinate::Kind::tool;
    const Eigen::Index row = static_cast<Eigen::Index>(c);
    const double mass = tool ? tools[at.pair].mass_kg : plain.mass(row, row);
    double damping = 2.0 * first_damping * std::sqrt(stiffness[c] * std::max(mass, 1e-9));
    constexpr double stiffness_varies = 0.06, damping_varies = 0.15;
    switch (at.kind) {
      case Coordinate::Kind::joint:
        if (cell_.arm.joints[at.joint].damping > 0.0) damping = cell_.arm.joints[at.joint].damping;
        add(Kind::joint_stiffness, c, std::log(stiffness[c]), 0.4, stiffness_varies);
        add(Kind::joint_damping, c, std::log(damping), 1.0, damping_varies);
        if (structure_.load) {
          add(Kind::joint_load, at.joint, 0.0, 0.15);
          add(Kind::joint_unloaded, at.joint, 0.0, 0.1);
        }
        break;
      case Coordinate::Kind::tilt:
        add(Kind::tilt_stiffness, c, std::log(stiffness[c]), 1.0);
        add(Kind::tilt_damping, c, std::log(damping), 1.0);
        break;
      case Coordinate::Kind::bracket:
        add(Kind::bracket_stiffness, c, std::log(stiffness[c]), 1.5);
        add(Kind::bracket_damping, c, std::log(damping), 1.0);
        break;
      case Coordinate::Kind::tool:
        add(Kind::tool_stiffness, c, std::log(stiffness[c]), 0.5);
        add(Kind::tool_damping, c, std::log(damping), 1.0);
        break;
    }
  }
  for (std::size_t t = 0; t < tools.size(); ++t) add(Kind::tool_mass, t, std::log(tools[t].mass_kg), 0.7);
  for (std::size_t k = 0; k < 3; ++k) add(Kind::compliance, k, 0.0, 3.0);
  for (std::size_t i = 0; i < cell_.arm.joints.size(); ++i) {
    const double rotor = cell_.arm.joints[i].rotor_inertia;
    if (rotor > 0.0) add(Kind::rotor_inertia, i, std::log(rotor), 0.2);
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    add(Kind::body_mass, b, 0.0, 0.2);
    add(Kind::body_inertia, b, 0.0, 0.2);
    const double arm = bodies_[b].link.center_m.norm();
    for (std::size_t k = 0; k < 3; ++k) add(Kind::body_center, b, 0.0, 0.02 + 0.1 * arm, 0.0, k);
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
Placed place_joints(const robot::Cell& cell, const Eigen::VectorXd& joints, std::vector<Eigen::Isometry3d>& before) {
  Placed out;
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
  const Placed placed = place_joints(cell_, joints, before);
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

FlexibleArm::System FlexibleArm::at(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters,
                                    bool derivatives) const {
  const Eigen::Index n = static_cast<Eigen::Index>(coordinates_.size());
  std::vector<Eigen::Isometry3d> before;
  const Placed placed = place_joints(cell_, joints, before);
  System out;
  out.flange_axes = placed.flange.linear();
  const Eigen::Vector3d tip = placed.flange * Eigen::Vector3d(0.0, 0.0, cell_.tool_length_m);
  Eigen::Matrix3Xd axis(3, n), origin(3, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    const bool outside = at.joint >= before.size();
    const Eigen::Isometry3d& frame = outside ? placed.flange : before[at.joint];
    axis.col(c) = frame.linear() * at.axis;
    origin.col(c) = frame.translation();
  }
  const auto translates = [&](const Coordinate& at) {
    return at.kind == Coordinate::Kind::tool ||
           (at.kind == Coordinate::Kind::joint && cell_.arm.joints[at.joint].prismatic);
  };
  const auto velocity = [&](Eigen::Index c, const Eigen::Vector3d& point) -> Eigen::Vector3d {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    return translates(at) ? Eigen::Vector3d(axis.col(c)) : Eigen::Vector3d(axis.col(c)).cross(point - origin.col(c));
  };
  out.input.resize(n, 3);
  for (Eigen::Index c = 0; c < n; ++c) out.input.row(c) = velocity(c, tip).transpose();

  // What the parameters say.
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(n), damping = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd rotor = Eigen::VectorXd::Zero(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
    if (at.kind == Coordinate::Kind::joint) rotor(c) = cell_.arm.joints[at.joint].rotor_inertia;
  }
  std::vector<double> mass_scale(bodies_.size(), 1.0), inertia_scale(bodies_.size(), 1.0);
  std::vector<Eigen::Vector3d> shift(bodies_.size(), Eigen::Vector3d::Zero());
  std::vector<double> tool_mass(static_cast<std::size_t>(structure_.tool_modes), 0.0);
  out.load = (gravity_torque(joints).array() / largest_load_.array()).min(2.0);
  out.coordinate.assign(parameters_.size(), -1);
  const auto joint_coordinate = [&](std::size_t joint) {
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      if (at.kind == Coordinate::Kind::joint && at.joint == joint) return c;
    }
    return Eigen::Index{-1};
  };
  Eigen::VectorXd log_factor = Eigen::VectorXd::Zero(n);
  const bool known = parameters.size() > 0;
  for (std::size_t p = 0; known && p < parameters_.size(); ++p) {
    const double value = parameters(static_cast<Eigen::Index>(p));
    const std::size_t index = parameters_[p].index;
    const Eigen::Index c = static_cast<Eigen::Index>(index);
    switch (parameters_[p].kind) {
      case Kind::joint_stiffness:
      case Kind::tilt_stiffness:
      case Kind::bracket_stiffness:
      case Kind::tool_stiffness:
        stiffness(c) = std::exp(value);
        out.coordinate[p] = c;
        break;
      case Kind::joint_damping:
      case Kind::tilt_damping:
      case Kind::bracket_damping:
      case Kind::tool_damping:
        damping(c) = std::exp(value);
        out.coordinate[p] = c;
        break;
      case Kind::joint_load:
        out.coordinate[p] = joint_coordinate(index);
        log_factor(out.coordinate[p]) += value * out.load(c);
        break;
      case Kind::joint_unloaded:
        out.coordinate[p] = joint_coordinate(index);
        log_factor(out.coordinate[p]) += value * unloaded(out.load(c));
        break;
      case Kind::tool_mass:
        tool_mass[index] = std::exp(value);
        break;
      case Kind::compliance:
        out.compliance(c) = value * compliance_unit_m_per_n;
        break;
      case Kind::rotor_inertia:
        out.coordinate[p] = joint_coordinate(index);
        rotor(out.coordinate[p]) = std::exp(value);
        break;
      case Kind::body_mass:
        mass_scale[index] = std::exp(value);
        break;
      case Kind::body_inertia:
        inertia_scale[index] = std::exp(value);
        break;
      case Kind::body_center:
        shift[index](static_cast<Eigen::Index>(parameters_[p].axis)) = value;
        break;
    }
  }
  out.stiffness = stiffness.array() * log_factor.array().exp();
  out.damping = damping;

  // Masses: bodies, rotors, tool.
  out.mass = Eigen::MatrixXd(rotor.asDiagonal());
  if (derivatives) out.mass_derivative.resize(parameters_.size());
  std::vector<Eigen::MatrixXd> of_mass(bodies_.size()), of_inertia(bodies_.size());
  std::vector<std::array<Eigen::MatrixXd, 3>> of_center(bodies_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    const Eigen::Isometry3d& frame = placed.after[body.joint];
    const Eigen::Vector3d center = frame * (body.link.center_m + shift[b]);
    const double mass = mass_scale[b] * body.link.mass_kg;
    const Eigen::Matrix3d inertia =
        mass_scale[b] * inertia_scale[b] * frame.linear() * body.link.inertia_kg_m2 * frame.linear().transpose();
    Eigen::Matrix3Xd linear = Eigen::Matrix3Xd::Zero(3, n), turning = Eigen::Matrix3Xd::Zero(3, n);
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      const bool moved = at.kind == Coordinate::Kind::bracket ? body.on_bracket
                         : at.kind == Coordinate::Kind::tool  ? false
                                                              : at.joint <= body.joint;
      if (!moved) continue;
      linear.col(c) = velocity(c, center);
      if (!translates(at)) turning.col(c) = axis.col(c);
    }
    const Eigen::MatrixXd turned = turning.transpose() * inertia * turning;
    const Eigen::MatrixXd whole = mass * (linear.transpose() * linear) + turned;
    out.mass += whole;
    if (!derivatives) continue;
    of_mass[b] = whole;
    of_inertia[b] = turned;
    for (Eigen::Index k = 0; k < 3; ++k) {
      Eigen::Matrix3Xd moved = Eigen::Matrix3Xd::Zero(3, n);
      for (Eigen::Index c = 0; c < n; ++c) {
        if (!turning.col(c).isZero(0.0)) moved.col(c) = turning.col(c).cross(Eigen::Vector3d(frame.linear().col(k)));
      }
      const Eigen::MatrixXd half = mass * (moved.transpose() * linear);
      of_center[b][static_cast<std::size_t>(k)] = half + half.transpose();
    }
  }
  std::vector<Eigen::MatrixXd> of_tool(tool_mass.size());
  for (std::size_t t = 0; t < tool_mass.size(); ++t) {
    Eigen::MatrixXd moved = out.input;
    for (Eigen::Index c = 0; c < n; ++c) {
      const Coordinate& at = coordinates_[static_cast<std::size_t>(c)];
      if (at.kind == Coordinate::Kind::tool && at.pair != t) moved.row(c).setZero();
    }
    const Eigen::MatrixXd whole = tool_mass[t] * (moved * moved.transpose());
    out.mass += whole;
    if (derivatives) of_tool[t] = whole;
  }
  for (std::size_t p = 0; derivatives && p < parameters_.size(); ++p) {
    const ArmParameter& parameter = parameters_[p];
    if (parameter.kind == Kind::body_mass) out.mass_derivative[p] = of_mass[parameter.index];
    if (parameter.kind == Kind::body_inertia) out.mass_derivative[p] = of_inertia[parameter.index];
    if (parameter.kind == Kind::body_center) out.mass_derivative[p] = of_center[parameter.index][parameter.axis];
    if (parameter.kind == Kind::tool_mass) out.mass_derivative[p] = of_tool[parameter.index];
    if (parameter.kind == Kind::rotor_inertia) {
      out.mass_derivative[p] = Eigen::MatrixXd::Zero(n, n);
      out.mass_derivative[p](out.coordinate[p], out.coordinate[p]) = rotor(out.coordinate[p]);
    }
  }
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
  const Eigen::MatrixXcd g = dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  value = system.input.transpose() * g + in_base(system);
  const auto store = [&](std::size_t p, const Eigen::Matrix3cd& d) {
    derivative.col(static_cast<Eigen::Index>(p)) = Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(d.data());
  };
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const Eigen::Index c = system.coordinate[p];
    const auto along = [&](Complex factor) { store(p, factor * (g.row(c).transpose() * g.row(c))); };
    switch (parameters_[p].kind) {
      case Kind::joint_stiffness:
      case Kind::tilt_stiffness:
      case Kind::bracket_stiffness:
      case Kind::tool_stiffness:
        along(-system.stiffness(c));
        break;
      case Kind::joint_load:
        along(-system.stiffness(c) * system.load(static_cast<Eigen::Index>(parameters_[p].index)));
        break;
      case Kind::joint_unloaded:
        along(-system.stiffness(c) * unloaded(system.load(static_cast<Eigen::Index>(parameters_[p].index))));
        break;
      case Kind::joint_damping:
      case Kind::tilt_damping:
      case Kind::bracket_damping:
      case Kind::tool_damping:
        along(-s * system.damping(c));
        break;
      case Kind::compliance: {
        const Eigen::Vector3d axis = system.flange_axes.col(static_cast<Eigen::Index>(parameters_[p].index));
        store(p, (compliance_unit_m_per_n * axis * axis.transpose()).cast<Complex>());
        break;
      }
      case Kind::tool_mass:
      case Kind::rotor_inertia:
      case Kind::body_mass:
      case Kind::body_inertia:
      case Kind::body_center:
        store(p, -s * s * (g.transpose() * (system.mass_derivative[p] * g)));
        break;
    }
  }
}

FlexibleArm::Modes FlexibleArm::modes(const System& system, double highest_hz) const {
  // In the undamped modes, of which those far above the band are left to the compliance.
  const Eigen::Index n = system.mass.rows();
  const Eigen::VectorXd scale = system.mass.diagonal().cwiseSqrt().cwiseInverse();
  const linear_algebra::SymmetricEigenPairs masses =
      linear_algebra::symmetric_eigen_pairs(scale.asDiagonal() * system.mass * scale.asDiagonal());
  const Eigen::MatrixXd root =
      scale.asDiagonal() * masses.vectors * masses.values.cwiseMax(1e-12).cwiseSqrt().cwiseInverse().asDiagonal();
  const linear_algebra::SymmetricEigenPairs undamped =
      linear_algebra::symmetric_eigen_pairs(root.transpose() * system.stiffness.asDiagonal() * root);
  const Eigen::MatrixXd shapes = root * undamped.vectors;
  const double beyond = std::pow(2.0 * std::numbers::pi * 2.5 * highest_hz, 2.0);
  Eigen::Index kept = 0;
  while (kept < n && undamped.values(kept) < beyond) ++kept;
  kept = std::clamp<Eigen::Index>(kept, 1, n);
  const Eigen::MatrixXd phi = shapes.leftCols(kept);
  const double rate = std::sqrt(std::max(undamped.values(kept - 1), 1e-12));
  Eigen::MatrixXd state = Eigen::MatrixXd::Zero(2 * kept, 2 * kept);
  state.topRightCorner(kept, kept).setIdentity();
  state.bottomLeftCorner(kept, kept) = -(undamped.values.head(kept) / (rate * rate)).asDiagonal().toDenseMatrix();
  state.bottomRightCorner(kept, kept) = -(phi.transpose() * system.damping.asDiagonal() * phi) / rate;
  const linear_algebra::EigenPairs pairs = linear_algebra::eigen_pairs(state);
  std::vector<Eigen::Index> order;
  for (Eigen::Index k = 0; k < 2 * kept; ++k) {
    if (pairs.values(k).imag() > 0.0) order.push_back(k);
  }
  std::ranges::sort(order, {}, [&](Eigen::Index k) { return std::abs(pairs.values(k)); });
  const Eigen::Matrix3Xd at_tip = system.input.transpose() * phi;
  Eigen::Matrix3d all = system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose();
  all += system.input.transpose() * system.stiffness.cwiseInverse().asDiagonal() * system.input;
  Modes out;
  out.rest = all;
  std::vector<Eigen::Index> inside;
  for (const Eigen::Index k : order) {
    if (std::abs(pairs.values(k)) * rate <= 2.0 * std::numbers::pi * highest_hz) inside.push_back(k);
  }
  const Eigen::Index m = static_cast<Eigen::Index>(inside.size());
  out.pole.resize(m);
  out.shape.resize(n, m);
  out.at_tip.resize(3, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const Eigen::Index from = inside[static_cast<std::size_t>(k)];
    const Complex pole = pairs.values(from) * rate;
    Eigen::VectorXcd small = pairs.vectors.col(from).head(kept);
    const Eigen::VectorXcd whole = phi * small;
    const Complex norm = (whole.transpose() * system.damping.asDiagonal() * whole).value() +
                         2.0 * pole * (small.transpose() * small).value();
    const Complex root_norm = std::sqrt(norm);
    out.pole(k) = pole;
    out.shape.col(k) = whole / root_norm;
    out.at_tip.col(k) = at_tip * small / root_norm;
    out.rest += 2.0 * (out.at_tip.col(k) * out.at_tip.col(k).transpose() / pole).real();
  }
  return out;
}

FlexibleArm::Sensitivity FlexibleArm::sensitivity(const System& system, const Modes& modes) const {
  const Eigen::Index m = modes.pole.size();
  const Eigen::Index count = static_cast<Eigen::Index>(parameters_.size());
  Sensitivity out;
  out.log_frequency.setZero(m, count);
  out.damping_ratio.setZero(m, count);
  out.residue.assign(static_cast<std::size_t>(m), Eigen::MatrixXcd::Zero(9, count));
  // Modes in the band and their conjugates span the shapes' changes; what is beyond is far.
  const Eigen::Index n = modes.shape.rows();
  Eigen::MatrixXcd basis(n, 2 * m);
  basis << modes.shape, modes.shape.conjugate();
  Eigen::VectorXcd poles(2 * m);
  poles << modes.pole, modes.pole.conjugate();
  Eigen::Matrix3Xcd tips(3, 2 * m);
  tips << modes.at_tip, modes.at_tip.conjugate();
  for (Eigen::Index p = 0; p < count; ++p) {
    const ArmParameter& parameter = parameters_[static_cast<std::size_t>(p)];
    if (parameter.kind == Kind::compliance) continue;
    const Eigen::Index c = system.coordinate[static_cast<std::size_t>(p)];
    const Eigen::MatrixXd& mass = system.mass_derivative[static_cast<std::size_t>(p)];
    double stiffness = 0.0, damping = 0.0;
    switch (parameter.kind) {
      case Kind::joint_load:
        stiffness = system.stiffness(c) * system.load(static_cast<Eigen::Index>(parameter.index));
        break;
      case Kind::joint_unloaded:
        stiffness = system.stiffness(c) * unloaded(system.load(static_cast<Eigen::Index>(parameter.index)));
        break;
      case Kind::joint_stiffness:
      case Kind::tilt_stiffness:
      case Kind::bracket_stiffness:
      case Kind::tool_stiffness:
        stiffness = system.stiffness(c);
        break;
      case Kind::joint_damping:
      case Kind::tilt_damping:
      case Kind::bracket_damping:
      case Kind::tool_damping:
        damping = system.damping(c);
        break;
      default:
        break;
    }
    for (Eigen::Index k = 0; k < m; ++k) {
      const Complex pole = modes.pole(k);
      // u = (dK + λ dC + λ² dM) ψ
      Eigen::VectorXcd projected;
      Complex self_norm = 0.0;
      if (mass.size() > 0) {
        const Eigen::VectorXcd moved = mass * modes.shape.col(k);
        projected = basis.transpose() * moved * (pole * pole);
        self_norm = 2.0 * pole * (modes.shape.col(k).transpose() * moved).value();
      } else {
        const Complex factor = stiffness + pole * damping;
        projected = basis.row(c).transpose() * (factor * modes.shape(c, k));
        self_norm = damping * modes.shape(c, k) * modes.shape(c, k);
      }
      const Complex shift = -projected(k);  // dλ
      const double size = std::abs(pole);
      const double d_size = (std::conj(pole) * shift).real() / size;
      out.log_frequency(k, p) = d_size / size;
      out.damping_ratio(k, p) = -shift.real() / size + pole.real() * d_size / (size * size);
      // ψ' = Σ_j a_j ψ_j with a_j = −(ψ_jᵀ u) / (λ_k − λ_j), a_k from the norm; ψᵀ(C + 2λM)ψ = 1 in state space.
      Eigen::Vector3cd moved_tip = Eigen::Vector3cd::Zero();
      for (Eigen::Index j = 0; j < 2 * m; ++j) {
        if (j == k) continue;
        moved_tip += tips.col(j) * (-projected(j) / (poles(k) - poles(j)));
      }
      moved_tip += modes.at_tip.col(k) * (-0.5 * self_norm);
      const Eigen::Vector3cd tip = modes.at_tip.col(k);
      const Eigen::Matrix3cd change = moved_tip * tip.transpose() + tip * moved_tip.transpose();
      const double norm = tip.squaredNorm();
      out.residue[static_cast<std::size_t>(k)].col(p) =
          Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(change.data()) / std::max(norm, 1e-300);
    }
  }
  return out;
}

}  // namespace robomill::modal::detail
