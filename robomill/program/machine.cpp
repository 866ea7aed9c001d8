#include "robomill/program/machine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace robomill::program {
namespace {

/// The largest |sin| between two angles.
double largest_sine(double from_rad, double to_rad) {
  const auto [low, high] = std::minmax(from_rad, to_rad);
  constexpr double pi = std::numbers::pi;
  const double peak = pi * std::ceil(low / pi - 0.5) + 0.5 * pi;  // the first at or above low
  return peak <= high ? 1.0 : std::max(std::abs(std::sin(low)), std::abs(std::sin(high)));
}

}  // namespace

Eigen::Vector3d tool_axis(Machine machine, double a_rad, double b_rad, double c_rad) {
  const double sin_c = std::sin(c_rad);
  const double cos_c = std::cos(c_rad);
  switch (machine) {
    case Machine::xyzac_trt:
      return {sin_c * std::sin(a_rad), cos_c * std::sin(a_rad), std::cos(a_rad)};
    case Machine::xyzbc_trt:
      return {-cos_c * std::sin(b_rad), sin_c * std::sin(b_rad), std::cos(b_rad)};
    case Machine::xyzac_head:
      return {sin_c * std::sin(a_rad), -cos_c * std::sin(a_rad), std::cos(a_rad)};
    case Machine::xyzbc_head:
      return {cos_c * std::sin(b_rad), sin_c * std::sin(b_rad), std::cos(b_rad)};
  }
  return Eigen::Vector3d::UnitZ();
}

Eigen::Index tilt_index(Machine machine) {
  return machine == Machine::xyzac_trt || machine == Machine::xyzac_head ? 0 : 1;
}

namespace {

/// C of a tool that a positive tilt leans to (x, y).
double turn_towards(Machine machine, double x, double y) {
  switch (machine) {
    case Machine::xyzac_trt:
      return std::atan2(x, y);
    case Machine::xyzbc_trt:
      return std::atan2(y, -x);
    case Machine::xyzac_head:
      return std::atan2(x, -y);
    case Machine::xyzbc_head:
      return std::atan2(y, x);
  }
  return 0.0;
}

}  // namespace

std::array<Eigen::Vector3d, 2> rotary_of_axis(Machine machine, const Eigen::Vector3d& axis, double free_c_rad) {
  constexpr double pole_rad = 1e-13;
  const double across = std::hypot(axis.x(), axis.y());
  const bool free = across <= pole_rad;
  const double tilt_rad = free ? (axis.z() > 0.0 ? 0.0 : std::numbers::pi) : std::atan2(across, axis.z());
  const double c_rad = free ? free_c_rad : turn_towards(machine, axis.x(), axis.y());
  std::array<Eigen::Vector3d, 2> out = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  out[0][tilt_index(machine)] = tilt_rad;
  out[0].z() = c_rad;
  out[1][tilt_index(machine)] = -tilt_rad;
  out[1].z() = free ? c_rad : c_rad + std::numbers::pi;
  return out;
}

Eigen::Vector3d nearest_rotary(Machine machine, const Eigen::Vector3d& axis, const Eigen::Vector3d& from_rad) {
  constexpr double turn = 2.0 * std::numbers::pi;
  constexpr double equal_rad = 1e-9;
  const Eigen::Index tilt = tilt_index(machine);
  Eigen::Vector3d best = from_rad;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& solution : rotary_of_axis(machine, axis, from_rad.z())) {
    Eigen::Vector3d at = from_rad;
    for (const Eigen::Index i : {tilt, Eigen::Index{2}}) {
      at[i] = solution[i] + turn * std::round((from_rad[i] - solution[i]) / turn);
    }
    const double distance = (at - from_rad).norm();
    if (distance >= nearest - equal_rad) continue;
    nearest = distance;
    best = at;
  }
  return best;
}

Eigen::Vector3d RotaryMove::axis_at(double share) const {
  // To the bit at its end, so that the same words again move nothing.
  const Eigen::Vector3d at = share == 1.0 ? end_rad : Eigen::Vector3d(begin_rad + share * (end_rad - begin_rad));
  return tool_axis(machine, at.x(), at.y(), at.z());
}

RotaryMove::Bounds RotaryMove::bounds() const {
  const Eigen::Index tilt = tilt_index(machine);
  const double from = begin_rad[tilt], to = end_rad[tilt];
  const double tilted = std::abs(to - from), turned = std::abs(end_rad.z() - begin_rad.z());
  const double sine = largest_sine(from, to);
  const double cosine = largest_sine(from + 0.5 * std::numbers::pi, to + 0.5 * std::numbers::pi);
  return {.speed = std::hypot(tilted, sine * turned),
          .acceleration = turned * cosine * std::hypot(sine * turned, 2.0 * tilted)};
}

namespace {

constexpr double longest_part_rad = 0.5;
constexpr double flatness = 7.5;

}  // namespace

double RotaryMove::parts(double tolerance_rad) const {
  const auto [speed, acceleration] = bounds();
  return std::max({1.0, std::ceil(speed / longest_part_rad - 1e-12),
                   std::ceil(std::sqrt(acceleration / (flatness * tolerance_rad)) - 1e-12)});
}

double RotaryMove::deviation_rad(double parts) const {
  return bounds().acceleration / (flatness * parts * parts);
}

}  // namespace robomill::program
