#pragma once
// An S-shaped path of our own under the tool's limits and the tolerances that [FirFiveAxis] states. Its path and its
// joints' limits stand in a figure and a table of which the text at hand has the captions alone.
#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "robomill/path/options.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/hybrid.hpp"

namespace robomill::path::test {

constexpr double degree = std::numbers::pi / 180.0;

/// [FirFiveAxis] sec. 3.1: tip 50 mm/s, 500, 10,000; axis 10°/s, 100, 2,000; 0.02 mm, 0.02°.
inline SmoothingOptions published_options(Method method) {
  SmoothingOptions o;
  o.method = method;
  o.tip_tolerance_m = 2e-5;
  o.axis_tolerance_rad = 0.02 * degree;
  o.max_velocity_m_per_s = 0.05;
  o.max_acceleration_m_per_s2 = 0.5;
  o.max_jerk_m_per_s3 = 10.0;
  o.max_angular_velocity_rad_per_s = 10.0 * degree;
  o.max_angular_acceleration_rad_per_s2 = 100.0 * degree;
  o.max_angular_jerk_rad_per_s3 = 2000.0 * degree;
  return o;
}

/// Two opposite half circles of eight chords each, 494 mm in all (9.88 s at 50 mm/s), the axis swinging sideways and to
/// and fro by up to 17°.
inline program::Program s_path() {
  program::Program program;
  const double chord = 0.494 / 16.0, pi = std::numbers::pi, step = pi / 8.0;
  const auto axis = [pi](int i) {
    const double u = i / 16.0;
    return Eigen::Vector3d(0.3 * std::sin(2.0 * pi * u), 0.12 * std::cos(3.0 * pi * u), 1.0).normalized();
  };
  program::Pose at = {.tip_m = {0.0, -0.247 / 1.6, 0.0}, .axis = axis(0)};
  program.start = at;
  for (int i = 1; i <= 16; ++i) {
    // The direction turns to the left over eight chords, then back to the right.
    const double heading = i <= 8 ? (i - 0.5) * step : pi - (i - 8.5) * step;
    at.tip_m += chord * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
    at.axis = axis(i);
    program.blocks.push_back({.kind = program::Block::Kind::feed,
                              .line = static_cast<std::size_t>(i),
                              .end = at,
                              .duration_s = chord / 0.05});
  }
  return program;
}

/// The hybrid machine with a tool of 100 mm, the part 750 mm before its base; all joints alike.
inline robot::HybridMachine s_machine(double acceleration, double jerk) {
  robot::HybridMachine machine;
  machine.tool_length_m = 0.1;
  machine.workpiece.linear() << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;  // W's z points back at the base
  machine.workpiece.translation() = Eigen::Vector3d(0.0, 0.0, 0.75);
  machine.limits.min_position << 0.2, 0.2, 0.2, -1.0, -1.0, 0.0;
  machine.limits.max_position << 1.5, 1.5, 1.5, 1.0, 1.0, 0.0;
  machine.limits.max_velocity << 0.2, 0.2, 0.2, 0.2, 0.2, 0.0;
  machine.limits.max_acceleration << Eigen::Matrix<double, 5, 1>::Constant(acceleration), 0.0;
  machine.limits.max_jerk << Eigen::Matrix<double, 5, 1>::Constant(jerk), 0.0;
  return machine;
}

}  // namespace robomill::path::test
