#include "robomill/report/smooth_sample.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "robomill/report/smooth_recorder.hpp"

namespace robomill::report {
namespace {

constexpr double period_s = 0.001;
constexpr double tolerance_m = 0.05e-3;

/// The program's pose at a length run along its path.
program::Pose pose_at(const program::Program& program, double run_m, std::size_t& block) {
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

LimitUse use(const char* what, LimitUse::Quantity quantity, int order, double max, double limit) {
  return {.what = what,
          .quantity = quantity,
          .order = order,
          .max = max,
          .limit = limit,
          .violations = max > limit ? 7U : 0U,
          .at_s = 0.4,
          .block = 3};
}

double largest(const signal::Band& band) {
  return std::max(band.high.maxCoeff(), -band.low.minCoeff());
}

std::vector<LimitUse> uses_of(const Motion& motion) {
  using enum LimitUse::Quantity;
  std::vector<LimitUse> uses = {use("tip, speed", length, 1, largest(motion.tip_speed_m_per_s), 0.05),
                                use("tip, distance to the program", length, 0, 0.021e-3, tolerance_m),
                                use("axis, speed", angle, 1, largest(motion.axis_speed_rad_per_s), 0.2),
                                use("tip, speed over the programmed", share, 0, 0.98, 1.0)};
  for (std::size_t i = 0; i < motion.joints.size(); ++i) {
    const JointMotion& joint = motion.joints[i];
    const LimitUse::Quantity kind = joint.prismatic ? length : angle;
    const std::string name = "joint " + std::to_string(i + 1);
    uses.push_back(use((name + ", velocity").c_str(), kind, 1, largest(joint.velocity), joint.max_velocity));
    uses.push_back(
        use((name + ", acceleration").c_str(), kind, 2, largest(joint.acceleration), joint.max_acceleration));
    uses.push_back(use((name + ", jerk").c_str(), kind, 3, largest(joint.jerk), joint.max_jerk));
  }
  return uses;
}

}  // namespace

SampleMachine::SampleMachine() {
  limits_.max_velocity << 0.06, 0.06, 0.06, 0.3, 0.3, 0.0;
  limits_.max_acceleration << 1.5, 1.5, 1.5, 3.0, 3.0, 0.0;
  limits_.max_jerk << 40.0, 40.0, 40.0, 60.0, 60.0, 0.0;
}

int SampleMachine::all(const robot::ToolPose& pose, robot::Position6* out, int room) const noexcept {
  if (room < 1) return 0;
  static_cast<void>(follow(pose, *out, *out));
  return 1;
}

robot::Reach SampleMachine::follow(const robot::ToolPose& pose, const robot::Position6&,
                                   robot::Position6& position) const noexcept {
  position << pose.tip_m, std::atan2(-pose.axis.y(), pose.axis.z()), std::asin(std::clamp(pose.axis.x(), -1.0, 1.0)),
      0.0;
  return {.status = robot::Reach::Status::found};
}

robot::Reach SampleMachine::follow(const robot::ToolJet&, const robot::Position6&, robot::JointJet&) const noexcept {
  return {};
}

robot::ToolPose SampleMachine::forward(const robot::Position6& q) const noexcept {
  robot::ToolPose pose;
  pose.tip_m = q.head<3>();
  pose.axis = Eigen::Vector3d(std::sin(q[4]), -std::sin(q[3]) * std::cos(q[4]), std::cos(q[3]) * std::cos(q[4]));
  return pose;
}

program::Program sample_program() {
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

std::vector<path::Sample> sample_motion(const program::Program& program, const SampleMachine& machine,
                                        double speed_m_per_s, const std::array<double, 2>& averages_s) {
  using Row = Eigen::Matrix<double, 7, 1>;  // tip, axis, block
  double length = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    length += (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  }
  std::vector<Row> rows;
  for (double run = 0.0; run < length; run += speed_m_per_s * period_s) {
    std::size_t block = 0;
    const program::Pose pose = pose_at(program, run, block);
    rows.push_back((Row() << pose.tip_m, pose.axis, static_cast<double>(block)).finished());
  }
  for (const double average_s : averages_s) {
    rows = averaged(rows, static_cast<std::size_t>(std::max(1.0, std::round(average_s / period_s))));
  }
  std::vector<path::Sample> samples(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    path::Sample& sample = samples[i];
    sample.time_s = static_cast<double>(i) * period_s;
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

Smooth sample_smooth() {
  const SampleMachine machine;
  const program::Program program = sample_program();
  program::ProgramSource source(program);
  const ProgramOutline outlined = outline(source, tolerance_m);
  Smooth smooth;
  smooth.facts = {{"Program", "zigzag.ngc, 12 blocks"}, {"Machine", "three slides, two turns"}};
  smooth.notes = {"A sample, not a prediction."};
  smooth.skipped = {"line 4: M8"};
  smooth.tip_tolerance_m = tolerance_m;
  smooth.max_tip_speed_m_per_s = 0.05;
  smooth.max_axis_speed_rad_per_s = 0.2;
  smooth.blocks = program.blocks.size();
  smooth.program_m = outlined.path_m;
  for (const ProgramCorner& corner : outlined.corners) {
    smooth.corners.push_back({.block = corner.block + 1,
                              .line = corner.line,
                              .turn_rad = corner.turn_rad,
                              .radius_m = corner.radius_m,
                              .program_m = corner.vertices_m});
  }
  struct Kind {
    const char* name;
    double speed_m_per_s;
    std::array<double, 2> averages_s;
  };
  for (const Kind& kind : {Kind{"verified", 0.03, {0.03, 0.03}}, Kind{"paper", 0.024, {0.04, 0.03}},
                           Kind{"no-joint-jerk", 0.034, {0.02, 0.01}}}) {
    MotionRecorder recorder(machine, {true, true, true, false, false, false}, period_s, outlined.corners);
    path::Sample last;
    recorder.restart([&last](const path::Sample& sample) -> robot::Position6 {
      robot::Position6 behind =
          sample.time_s > 0.0 ? robot::Position6(0.2 * (sample.joints - last.joints)) : robot::Position6::Zero();
      last = sample;
      return behind;
    });
    recorder.add(sample_motion(program, machine, kind.speed_m_per_s, kind.averages_s));
    SmoothMethod method{.name = kind.name, .motion = recorder.motion()};
    method.uses = uses_of(method.motion);
    method.duration_s = method.motion.run_s * static_cast<double>(method.motion.tip_speed_m_per_s.low.size());
    method.samples = static_cast<std::size_t>(method.duration_s / period_s);
    method.joint_share = 0.0;
    for (const LimitUse& each : method.uses) method.joint_share = std::max(method.joint_share, each.max / each.limit);
    method.tip_error_m = 0.021e-3;
    method.axis_error_rad = 1e-4;
    method.plan_s = 0.3;
    method.sample_s = 3e-6;
    method.tracking_error_m = largest(method.motion.joints[0].tracking_error);
    method.tracking_error_rad = largest(method.motion.joints[4].tracking_error);
    if (smooth.methods.empty()) method.lower_bound_s = 0.9 * method.duration_s;
    if (!smooth.methods.empty()) method.sum_t2_s = 2.355;
    smooth.methods.push_back(std::move(method));
    const std::vector<Eigen::Matrix2Xd> ways = recorder.corner_paths();
    for (std::size_t i = 0; i < ways.size(); ++i) smooth.corners[i].tip_m.push_back(ways[i]);
  }
  return smooth;
}

}  // namespace robomill::report
