#include "robomill/modal/posture/flexible_arm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal::detail {
namespace {

using Kind = ArmParameter::Kind;

Eigen::Vector3d across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d least = std::abs(axis.x()) <= std::abs(axis.y()) && std::abs(axis.x()) <= std::abs(axis.z())
                                    ? Eigen::Vector3d::UnitX()
                                : std::abs(axis.y()) <= std::abs(axis.z()) ? Eigen::Vector3d::UnitY()
                                                                           : Eigen::Vector3d::UnitZ();
  return axis.cross(least).normalized();
}

}  // namespace

bool is_stiffness(Kind kind) {
  return kind == Kind::joint_stiffness || kind == Kind::tilt_stiffness || kind == Kind::bracket_stiffness ||
         kind == Kind::tool_stiffness;
}

bool is_damping(Kind kind) {
  return kind == Kind::joint_damping || kind == Kind::tilt_damping || kind == Kind::bracket_damping ||
         kind == Kind::tool_damping;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d out;
  out << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return out;
}

FlexibleArm::FlexibleArm(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                         const ArmStructure& structure, const std::vector<Tool>& tools)
    : cell_(cell), structure_(structure), tools_(tools) {
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
  const System plain = at(Eigen::VectorXd::Constant(cell_.arm.size(), 0.5), {});
  for (const Group& group : groups_) add_group_parameters(group, tools, plain);
  add_mass_parameters(tools);
}

void FlexibleArm::split_last_link() {
  // What of it does not ride on the bracket is not told. A tenth of its inertia, between joint and flange, is where to
  // start; both parts together are the link.
  constexpr double inner_inertia_share = 0.1, least_inertia_share = 0.3;
  Body& outer = bodies_.back();
  const robot::Link whole = outer.link;
  Body inner = outer;
  inner.on_bracket = false;
  inner.loose = outer.loose = true;
  inner.link.mass_kg = structure_.inner_share * whole.mass_kg;
  inner.link.center_m = 0.5 * cell_.arm.flange.translation();
  inner.link.inertia_kg_m2 = inner_inertia_share * whole.inertia_kg_m2;
  outer.link.mass_kg = whole.mass_kg - inner.link.mass_kg;
  outer.link.center_m =
      (whole.mass_kg * whole.center_m - inner.link.mass_kg * inner.link.center_m) / outer.link.mass_kg;
  const Eigen::Vector3d apart = outer.link.center_m - inner.link.center_m;
  const Eigen::Matrix3d between = inner.link.mass_kg * outer.link.mass_kg / whole.mass_kg *
                                  (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
  const Eigen::Matrix3d left = (1.0 - inner_inertia_share) * whole.inertia_kg_m2;
  const Eigen::Matrix3d inertia = left - between;
  const bool sound = linear_algebra::symmetric_eigen_pairs(inertia - least_inertia_share * left).values(0) > 0.0;
  outer.link.inertia_kg_m2 = sound ? inertia : Eigen::Matrix3d(least_inertia_share * left);
  bodies_.push_back(inner);
}

void FlexibleArm::add_coordinates() {
  const std::size_t n = cell_.arm.joints.size();
  using Is = Coordinate::Kind;
  const auto put = [&](const std::vector<Coordinate>& together) {
    groups_.push_back({.kind = together[0].kind, .first = coordinates_.size(), .count = together.size()});
    coordinates_.insert(coordinates_.end(), together.begin(), together.end());
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d axis = cell_.arm.joints[i].axis.normalized();
    put({{.kind = Is::joint, .joint = i, .axis = axis}});
    if (!structure_.bearings) continue;
    const Eigen::Vector3d first = across(axis);
    put({{.kind = Is::tilt, .joint = i, .axis = first}});
    put({{.kind = Is::tilt, .joint = i, .axis = axis.cross(first)}});
  }
  bracket_row_ = static_cast<Eigen::Index>(coordinates_.size());
  const auto along = [&](Is kind, std::size_t pair, int k) {
    return Coordinate{.kind = kind, .joint = n, .pair = pair, .axis = Eigen::Vector3d::Unit(k)};
  };
  if (structure_.bracket) put({along(Is::bracket, 0, 0), along(Is::bracket, 0, 1), along(Is::bracket, 0, 2)});
  for (std::size_t t = 0; t < static_cast<std::size_t>(structure_.tool_modes); ++t) {
    put({along(Is::tool, t, 0), along(Is::tool, t, 1)});
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
    double carried_kg = 0.0;
    for (std::size_t t = at.pair; t < tools.size(); ++t) carried_kg += tools[t].mass_kg;
    return carried_kg * rate * rate;
  }
  const double joint = cell_.arm.joints[std::min(at.joint, cell_.arm.joints.size() - 1)].stiffness;
  return at.kind == Coordinate::Kind::joint ? joint : tilts_over_joint * joint;
}

void FlexibleArm::add_group_parameters(const Group& group, const std::vector<Tool>& tools, const System& plain) {
  // What a coordinate moves in the middle of its range decides its first guess of damping.
  constexpr double first_damping_ratio = 0.02;
  constexpr double stiffness_varies = 0.06, damping_varies = 0.15;
  for (std::size_t c = group.first; c < group.first + group.count; ++c) {
    const Coordinate& at = coordinates_[c];
    const Eigen::Index row = static_cast<Eigen::Index>(c);
    const double mass = at.kind == Coordinate::Kind::tool ? tools[at.pair].mass_kg : plain.mass(row, row);
    const double stiffness = first_stiffness(at, tools);
    double damping = 2.0 * first_damping_ratio * std::sqrt(stiffness * std::max(mass, 1e-9));
    const auto matrix = [&](Kind of_stiffness, Kind of_damping, double deviation, double coupled) {
      add(of_stiffness, c, std::log(stiffness), deviation);
      add(of_damping, c, std::log(damping), 1.0);
      for (std::size_t k = 1; c + k < group.first + group.count; ++k) {
        add(of_stiffness, c, 0.0, coupled, 0.0, k);
        add(of_damping, c, 0.0, 0.5, 0.0, k);
      }
    };
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
        matrix(Kind::bracket_stiffness, Kind::bracket_damping, 1.5, 0.7);
        break;
      case Coordinate::Kind::tool:
        matrix(Kind::tool_stiffness, Kind::tool_damping, 0.5, 0.1);
        break;
    }
  }
}

void FlexibleArm::add_mass_parameters(const std::vector<Tool>& tools) {
  constexpr double pivot_over_tool_length = 0.4;
  for (std::size_t k = 0; structure_.bracket && k < 3; ++k) {
    add(Kind::bracket_pivot, k, 0.0, pivot_over_tool_length * cell_.tool_length_m);
  }
  for (std::size_t t = 0; t < tools.size(); ++t) {
    add(Kind::tool_mass, t, std::log(tools[t].mass_kg), 0.7);
  }
  // Modes beyond those of the chain are known along the spindle's axis alone.
  for (std::size_t k = tools.empty() ? 0 : 2; k < 3; ++k) add(Kind::compliance, k, 0.0, 3.0);
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

}  // namespace robomill::modal::detail
