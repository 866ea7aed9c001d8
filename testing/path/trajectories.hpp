#pragma once
// Trajectories that tests of writers share: joints along sines, a pause in the middle.
#include <cmath>
#include <cstddef>
#include <vector>

#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/sample.hpp"

namespace robomill::path::test {

inline constexpr double period_s = 0.001;

/// @param pause  samples that stand still from the middle on
inline std::vector<Sample> sines(std::size_t count, std::size_t pause = 0) {
  std::vector<Sample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t middle = count / 2;
    const std::size_t moved = i <= middle ? i : (i <= middle + pause ? middle : i - pause);
    const double t = static_cast<double>(moved) * period_s;
    Sample& sample = samples[i];
    sample.time_s = static_cast<double>(i) * period_s;
    for (int joint = 0; joint < 6; ++joint) {
      sample.joints[joint] =
          (joint % 2 == 0 ? 1.0 : -1.0) * (0.3 + 0.1 * joint) * (1.0 - std::cos((1.0 + 0.3 * joint) * t));
    }
    sample.tip_m = Eigen::Vector3d(0.01 * std::sin(t), -0.02 * t, 0.03 * std::cos(3.0 * t));
    sample.axis = Eigen::Vector3d(std::sin(0.2 * t), 0.0, std::cos(0.2 * t));
    sample.block = i / 7;
  }
  return samples;
}

inline TrajectoryInfo arm_info() {
  TrajectoryInfo info;
  info.joints = 6;
  info.limits.min_position.setConstant(-3.0);
  info.limits.max_position.setConstant(3.1);
  info.limits.max_velocity.setConstant(2.0);
  info.limits.max_acceleration.setConstant(5.0);
  info.limits.max_jerk << 50, 51, 52, 53, 54, 55;
  info.cell = "cell.toml";
  info.program = "part.ngc";
  return info;
}

}  // namespace robomill::path::test
