#include <Eigen/LU>
#include <complex>

#include "robomill/modal/posture/flexible_arm.hpp"

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using Kind = ArmParameter::Kind;

Eigen::Matrix3d cross(const Eigen::Vector3d& a) {
  Eigen::Matrix3d out;
  out << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return out;
}

/// The velocity of a centre that moves out by a unit along an axis of its link, from the angular one.
template <class Matrix>
Matrix swung(const FlexibleArm::BodyMotion& body, std::size_t axis, const Matrix& turned) {
  return -cross(body.axes.col(static_cast<Eigen::Index>(axis))) * turned;
}

Eigen::Matrix3cd in_base(const FlexibleArm::System& system) {
  return (system.flange_axes * system.compliance.asDiagonal() * system.flange_axes.transpose()).cast<Complex>();
}

Eigen::MatrixXcd dynamic_stiffness(const FlexibleArm::System& system, Complex s) {
  return s * s * system.mass + s * system.damping + system.stiffness;
}

}  // namespace

Eigen::Matrix3Xcd FlexibleArm::pivot_change(const System& system, std::size_t axis, const Eigen::MatrixXcd& x) const {
  // A coordinate about e moves a point p by e x (p - pivot); the bracket's axes are the flange's.
  return system.flange_axes * cross(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis))) *
         x.middleRows(bracket_row_, 3);
}

Eigen::MatrixXcd FlexibleArm::mass_change(const System& system, const ArmParameter& parameter,
                                          const Eigen::MatrixXcd& x) const {
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(x.rows(), x.cols());
  if (parameter.kind == Kind::rotor_inertia) {
    const Eigen::Index c = joint_row(parameter.index);
    out.row(c) = system.rotor(c) * x.row(c);
    return out;
  }
  if (parameter.kind == Kind::tool_mass) {
    const ToolMotion& tool = system.tools[parameter.index];
    return tool.mass_kg * (tool.input * (tool.input.transpose() * x));
  }
  if (parameter.kind == Kind::bracket_pivot) {
    const Eigen::Matrix3Xcd moved = pivot_change(system, parameter.index, x);
    const Eigen::Matrix3d turn =
        -cross(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(parameter.index))) * system.flange_axes.transpose();
    const auto add = [&](double mass, const Eigen::MatrixXd& motion) {  // motion: 3 x n
      out += mass * (motion.transpose() * moved);
      out.middleRows(bracket_row_, 3) += mass * (turn * (motion * x));
    };
    for (const BodyMotion& body : system.bodies) {
      if (body.on_bracket) add(body.mass_kg, body.linear);
    }
    for (const ToolMotion& tool : system.tools) add(tool.mass_kg, tool.input.transpose());
    return out;
  }
  const BodyMotion& body = system.bodies[parameter.index];
  const Eigen::MatrixXcd turned = body.turning * x, moved = body.linear * x;
  if (parameter.kind == Kind::body_center) {
    const Eigen::Matrix3Xd arm = swung(body, parameter.axis, body.turning);
    return body.mass_kg * (arm.transpose() * moved + body.linear.transpose() * swung(body, parameter.axis, turned));
  }
  out = body.turning.transpose() * (body.inertia * turned);
  if (parameter.kind == Kind::body_mass) out += body.mass_kg * (body.linear.transpose() * moved);
  return out;
}

Eigen::Matrix3cd FlexibleArm::receptance(const System& system, Complex s) {
  const Eigen::MatrixXcd moved = dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  return system.input.transpose() * moved + in_base(system);
}

/// What masses do at one s: gᵀ ∂M g is found from 3 x 3 matrices.
struct FlexibleArm::MassTerms {
  std::vector<Eigen::Matrix3cd> moved, turned;  // of a body's centre, and its turning
  std::vector<Eigen::Matrix3cd> tool;           // B_tᵀ g of a pair

  MassTerms(const System& system, const Eigen::Matrix<Complex, Eigen::Dynamic, 3>& g) {
    for (const BodyMotion& body : system.bodies) {
      moved.emplace_back(body.linear * g);
      turned.emplace_back(body.turning * g);
    }
    for (const ToolMotion& pair : system.tools) tool.emplace_back(pair.input.transpose() * g);
  }
  /// gᵀ ∂M g
  [[nodiscard]] Eigen::Matrix3cd change(const System& system, const ArmParameter& parameter) const {
    const std::size_t index = parameter.index;
    if (parameter.kind == Kind::tool_mass) return system.tools[index].mass_kg * (tool[index].transpose() * tool[index]);
    const BodyMotion& body = system.bodies[index];
    if (parameter.kind == Kind::body_center) {
      const Eigen::Matrix3cd half =
          body.mass_kg * (swung(body, parameter.axis, turned[index]).transpose() * moved[index]);
      return half + half.transpose();
    }
    Eigen::Matrix3cd out = turned[index].transpose() * body.inertia * turned[index];
    if (parameter.kind == Kind::body_mass) out += body.mass_kg * (moved[index].transpose() * moved[index]);
    return out;
  }
  /// The same as the bracket's pivot moves. @param by  ∂Bᵀ g
  [[nodiscard]] Eigen::Matrix3cd pivot(const System& system, const Eigen::Matrix3cd& by) const {
    Eigen::Matrix3cd half = Eigen::Matrix3cd::Zero();
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
      if (system.bodies[b].on_bracket) half += system.bodies[b].mass_kg * (by.transpose() * moved[b]);
    }
    for (std::size_t t = 0; t < system.tools.size(); ++t) {
      half += system.tools[t].mass_kg * (by.transpose() * tool[t]);
    }
    return half + half.transpose();
  }
};

void FlexibleArm::receptance(const System& system, Complex s, Eigen::Matrix3cd& value,
                             Eigen::Ref<Eigen::Matrix<Complex, 9, Eigen::Dynamic>> derivative) const {
  const Eigen::Matrix<Complex, Eigen::Dynamic, 3> g =
      dynamic_stiffness(system, s).partialPivLu().solve(system.input.cast<Complex>());
  value = system.input.transpose() * g + in_base(system);
  const MassTerms masses(system, g);
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    const ArmParameter& parameter = parameters_[p];
    const SpringChange& spring = system.springs[p];
    Eigen::Matrix3cd change;  // ∂H = −gᵀ (∂K + s ∂C + s² ∂M) g, and what the input changes by
    if (spring.count == 1) {
      const Complex by = spring.stiffness(0, 0) + s * spring.damping(0, 0);
      change = -by * (g.row(spring.first).transpose() * g.row(spring.first));
    } else if (spring.count > 1) {
      const Eigen::Index k = spring.count;
      change = -g.middleRows(spring.first, k).transpose() *
               ((spring.stiffness + s * spring.damping).topLeftCorner(k, k) * g.middleRows(spring.first, k));
    } else if (parameter.kind == Kind::compliance) {
      const Eigen::Vector3d axis = system.flange_axes.col(static_cast<Eigen::Index>(parameter.index));
      change = (compliance_unit_m_per_n * axis * axis.transpose()).cast<Complex>();
    } else if (parameter.kind == Kind::rotor_inertia) {
      const Eigen::Index c = joint_row(parameter.index);
      change = -s * s * system.rotor(c) * (g.row(c).transpose() * g.row(c));
    } else if (parameter.kind == Kind::bracket_pivot) {
      const Eigen::Matrix3cd by = pivot_change(system, parameter.index, g);
      change = by + by.transpose() - s * s * masses.pivot(system, by);
    } else {
      change = -s * s * masses.change(system, parameter);
    }
    derivative.col(static_cast<Eigen::Index>(p)) = Eigen::Map<const Eigen::Matrix<Complex, 9, 1>>(change.data());
  }
}

}  // namespace robomill::modal::detail
