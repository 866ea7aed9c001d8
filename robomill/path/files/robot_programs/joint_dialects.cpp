#include "robomill/path/files/robot_programs/joint_dialects.hpp"

#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/robot/euler.hpp"

namespace robomill::path {
namespace {

constexpr double degree_digits = 1e6;

/// The nearest 32-bit number. Volatile: where it vectorises, g++ 12 drops the conversion there and back.
double as_real(double value) {
  const volatile float real = static_cast<float>(value);
  return static_cast<double>(real);
}

}  // namespace

void JointDialect::degrees(fmt::memory_buffer& out, const robot::Position6& joints, bool named) {
  for (int joint = 0; joint < 6; ++joint) {
    if (joint > 0) out.push_back(',');
    if (named) io::append(out, "A{} ", joint + 1);
    io::append(out, "{:.6f}", joints[joint] / units::deg);
  }
}

robot::Position6 JointDialect::held_degrees(const robot::Position6& joints) {
  const robot::Position6 written = (joints / units::deg * degree_digits).array().round() / degree_digits;
  return written.unaryExpr(&as_real) * units::deg;
}

void JointDialect::add_missing_outputs(const EndEffector& end, const Outputs& wanted, std::vector<std::string>& lines) {
  if (wanted.spindle && !end.spindle.given()) {
    lines.emplace_back("NOT SET: the spindle (spindle.output in the cell). Start it by hand before this program runs.");
  }
  if (wanted.coolant && !end.coolant.given()) {
    lines.emplace_back("NOT SET: coolant (spindle.coolant_output in the cell).");
  }
}

void JointDialect::add_assumed_load(const EndEffector& end, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("ASSUMED of the load of {:.6g} kg: {}no moments of inertia", *end.mass_kg,
                              end.center_m ? "" : "its centre half-way to the tip (tool.center_mm), "));
}

std::string JointDialect::euler_pose(const Eigen::Isometry3d& frame) {
  const robot::Euler turn = robot::euler_of(frame.linear());
  return three(frame.translation(), units::mm, "X {:.3f},Y {:.3f},Z {:.3f},") +
         three({turn.a_rad, turn.b_rad, turn.c_rad}, units::deg, "A {:.4f},B {:.4f},C {:.4f}");
}

std::string JointDialect::three(const Eigen::Vector3d& value, double unit, const char* form) {
  const Eigen::Vector3d v = value / unit + Eigen::Vector3d::Zero();  // no -0
  return fmt::format(fmt::runtime(form), v.x(), v.y(), v.z());
}

}  // namespace robomill::path
