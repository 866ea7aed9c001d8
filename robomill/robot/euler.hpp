#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace robomill::robot {

/// R = Rz(a) Ry(b) Rx(c): KUKA's A, B, C; FANUC's R, P, W and Yaskawa's Rz, Ry, Rx; [workpiece] rotation_deg backwards.
struct Euler {
  double a_rad = 0.0, b_rad = 0.0, c_rad = 0.0;  ///< b in [-π/2, π/2], the others in (-π, π]
};

/// Where b is ±π/2 and only one turn is left of a and c, a is 0.
[[nodiscard]] inline Euler euler_of(const Eigen::Matrix3d& turn) {
  constexpr double pole = 1e-9;
  const double flat = std::hypot(turn(0, 0), turn(1, 0));
  const auto angle = [](double y, double x) {
    const double at = std::atan2(y, x);
    return at < pole - std::numbers::pi ? at + 2.0 * std::numbers::pi : at;  // half a turn has one sign
  };
  Euler out{.b_rad = std::atan2(-turn(2, 0), flat)};
  if (flat < pole) {
    out.c_rad = angle(turn(2, 0) < 0.0 ? turn(0, 1) : -turn(0, 1), turn(1, 1));
    return out;
  }
  out.a_rad = angle(turn(1, 0), turn(0, 0));
  out.c_rad = angle(turn(2, 1), turn(2, 2));
  return out;
}

}  // namespace robomill::robot
