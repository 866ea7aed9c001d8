#include "robomill/program/machine.hpp"

#include <algorithm>
#include <cmath>
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

Eigen::Vector3d RotaryMove::axis_at(double share) const {
  const Eigen::Vector3d at = begin_rad + share * (end_rad - begin_rad);
  return tool_axis(machine, at.x(), at.y(), at.z());
}

RotaryMove::Bounds RotaryMove::bounds() const {
  const Eigen::Index tilt = machine == Machine::xyzac_trt || machine == Machine::xyzac_head ? 0 : 1;
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
