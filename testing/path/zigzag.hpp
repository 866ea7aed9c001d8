#pragma once
// A short program with sharp corners, and a motion along it that needs no planner.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "robomill/path/sample.hpp"
#include "robomill/program/program.hpp"
#include "testing/path/machine.hpp"

namespace robomill::path::test {

inline constexpr double zigzag_period_s = 0.001;
inline constexpr double zigzag_tolerance_m = 0.05e-3;

/// Three slides and two tilts, the tip where the tilts turn.
inline TiltHead zigzag_machine() {
  robot::JointLimits limits = tilt_head_limits();
  limits.max_velocity << 0.06, 0.06, 0.06, 0.3, 0.3, 0.0;
  limits.max_acceleration << 1.5, 1.5, 1.5, 3.0, 3.0, 0.0;
  limits.max_jerk << 40.0, 40.0, 40.0, 60.0, 60.0, 0.0;
  return TiltHead(limits, 0.0);
}

/// A zigzag with a leaning axis.
inline program::Program zigzag_program() {
  program::Program program;
  for (int i = 1; i <= 12; ++i) {
    program::Block block;
    block.line = static_cast<std::size_t>(10 + i);
    block.end.tip_m =
        Eigen::Vector3d((i % 2 == 0 ? 0.0 : 0.012), 0.0015 * std::floor(0.5 * i), 0.004 * std::sin(0.5 * i));
    block.end.axis = Eigen::Vector3d(0.05 * std::sin(0.6 * i), 0.1 * std::cos(0.4 * i), 1.0).normalized();
    block.duration_s = 0.3;
    program.blocks.push_back(block);
  }
  program.start.axis = Eigen::Vector3d(0.0, 0.1, 1.0).normalized();
  return program;
}

/// The program's pose at a length run along its path.
inline program::Pose pose_at(const program::Program& program, double run_m, std::size_t& block) {
  double left = run_m;
  for (block = 0; block < program.blocks.size(); ++block) {
    const program::Pose& from = program.begin_of(block);
    const program::Pose& to = program.blocks[block].end;
    const double length = (to.tip_m - from.tip_m).norm();
    if (left <= length) return program::between(from, to, left / length);
    left -= length;
  }
  --block;
  return program.blocks.back().end;
}

/// A vector's moving average, at rest before and after.
template <class Vector>
std::vector<Vector> averaged(const std::vector<Vector>& in, std::size_t taps) {
  std::vector<Vector> out(in.size() + taps - 1);
  for (std::size_t i = 0; i < out.size(); ++i) {
    Vector sum = Vector::Zero();
    for (std::size_t k = 0; k < taps; ++k) {
      sum += in[std::min(i > k ? i - k : 0, in.size() - 1)];
    }
    out[i] = sum / static_cast<double>(taps);
  }
  return out;
}

/// A program at an even speed through two moving averages, by zigzag_machine().
/// @param averages_s  their lengths
inline std::vector<Sample> averaged_motion(const program::Program& program, double speed_m_per_s,
                                           const std::array<double, 2>& averages_s) {
  using Row = Eigen::Matrix<double, 7, 1>;  // tip, axis, block
  double length = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    length += (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  }
  std::vector<Row> rows;
  for (double run = 0.0; run < length; run += speed_m_per_s * zigzag_period_s) {
    std::size_t block = 0;
    const program::Pose pose = pose_at(program, run, block);
    rows.push_back((Row() << pose.tip_m, pose.axis, static_cast<double>(block)).finished());
  }
  for (const double average_s : averages_s) {
    rows = averaged(rows, static_cast<std::size_t>(std::max(1.0, std::round(average_s / zigzag_period_s))));
  }
  const TiltHead machine = zigzag_machine();
  std::vector<Sample> samples(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Sample& sample = samples[i];
    sample.time_s = static_cast<double>(i) * zigzag_period_s;
    sample.tip_m = rows[i].head<3>();
    sample.axis = rows[i].segment<3>(3).normalized();
    sample.block = static_cast<std::size_t>(std::lround(rows[i][6]));
    robot::ToolPose pose;
    pose.tip_m = sample.tip_m;
    pose.axis = sample.axis;
    static_cast<void>(machine.follow(pose, sample.joints, sample.joints));
  }
  return samples;
}

}  // namespace robomill::path::test
