#pragma once
// Programs and trajectories for tests of the checker.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "robomill/path/check.hpp"
#include "testing/path/machine.hpp"

namespace robomill::path::test {

inline SmoothingOptions options() {
  SmoothingOptions o;
  o.tip_tolerance_m = 2e-5;
  o.axis_tolerance_rad = 3.5e-4;
  o.max_velocity_m_per_s = 0.1;
  o.max_acceleration_m_per_s2 = 1.0;
  o.max_jerk_m_per_s3 = 20.0;
  o.max_angular_velocity_rad_per_s = 0.5;
  o.max_angular_acceleration_rad_per_s2 = 4.0;
  o.max_angular_jerk_rad_per_s3 = 80.0;
  return o;
}

// Rest to rest with a jerk of ±j in four equal quarters of the time: an exact polynomial.
inline double quarters(double share, double distance) {
  const double j = 32.0 * distance;  // distance = j T³ / 32
  const auto half = [j](double t) {
    if (t <= 0.25) return j * t * t * t / 6.0;
    const double v = j * 0.25 * 0.25 / 2.0, a = j * 0.25, s = t - 0.25;
    return j * std::pow(0.25, 3) / 6.0 + v * s + a * s * s / 2.0 - j * s * s * s / 6.0;
  };
  share = std::clamp(share, 0.0, 1.0);
  return share <= 0.5 ? half(share) : distance - half(1.0 - share);
}

struct Fixture {
  Fixture() { program.start = program::Pose(); }
  Fixture& move(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double duration_s,
                program::Block::Kind kind = program::Block::Kind::feed) {
    program.blocks.push_back(
        {.kind = kind, .end = {.tip_m = tip, .axis = axis.normalized()}, .duration_s = duration_s});
    return *this;
  }
  /// Samples of a motion that runs through the blocks one by one, `seconds[i]` each.
  std::vector<Sample> stop_and_go(const std::vector<double>& seconds) const {
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      for (double t = i == 0 ? 0.0 : 0.001; t < seconds[i] + 1e-9; t += 0.001) {
        const program::Block& block = program.blocks[i];
        const double share = block.kind == program::Block::Kind::dwell ? 0.0 : quarters(t / seconds[i], 1.0);
        const program::Pose to = block.kind == program::Block::Kind::dwell ? program.begin_of(i) : block.end;
        samples.push_back(
            sample(static_cast<double>(samples.size()) * 1e-3, program::between(program.begin_of(i), to, share), i));
      }
    }
    return samples;
  }
  Sample sample(double time_s, const program::Pose& pose, std::size_t block) const {
    Sample s = {.time_s = time_s, .tip_m = pose.tip_m, .axis = pose.axis, .block = block};
    (void)machine.follow(robot::ToolPose{.tip_m = pose.tip_m, .axis = pose.axis}, robot::Position6::Zero(), s.joints);
    return s;
  }
  CheckResult check(const std::vector<Sample>& samples, const SmoothingOptions& o = options()) const {
    program::ProgramSource source(program);
    Checker checker(source, machine, o);
    checker.add(samples);
    return checker.finish();
  }
  program::Program program;
  TiltHead machine{tilt_head_limits()};
};

}  // namespace robomill::path::test
