#include "robomill/path/published/fir.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/path/published/fir_corner.hpp"
#include "robomill/path/published/fir_joint.hpp"

namespace robomill::path {

using Eigen::Vector3d;
using Eigen::Vector4d;
using program::Block;
using program::Pose;
using robot::Reach;

namespace {

constexpr double half_turn_margin_rad = 1e-9;

double gamma_at_boundary(const std::vector<double>& gamma_rad, std::size_t boundary) {
  if (gamma_rad.empty()) return 0.0;
  return gamma_rad.size() == 1 ? gamma_rad[0] : gamma_rad[boundary];
}

std::string number(double value) {
  std::array<char, 32> text = {};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

[[noreturn]] void reject(const program::Program& program, std::size_t block, const Reach& reach) {
  std::string rule;
  switch (reach.status) {
    case Reach::Status::out_of_reach:
      rule = "out of the machine's reach by " + number(reach.beyond) + " m";
      break;
    case Reach::Status::outside_limits:
      rule = "puts joint " + std::to_string(reach.joint + 1) + " beyond its limit by " + number(reach.beyond) +
             " (rad or m)";
      break;
    case Reach::Status::singular:
      rule = "leads through a singularity";
      break;
    default:
      rule = "makes the joints jump";
      break;
  }
  throw InvalidInput("block " + std::to_string(block + 1) + " (line " +
                         std::to_string(program.blocks[std::min(block, program.blocks.size() - 1)].line) + ")",
                     rule);
}

// A pulse behind its filters.
Boxes boxes_of(const FirConstants& c, int filters) {
  Boxes boxes;
  boxes.add(c.t1_s);
  boxes.add(c.t2_s);
  if (filters >= 2) boxes.add(c.t3_s);
  if (filters >= 3) boxes.add(0.5 * c.t3_s);
  return boxes;
}

// Of a pulse of speed v (or ω) for a way, behind filters by the limits of acceleration and jerk.
FirConstants constants_of(double way, double t1_s, double acceleration, double jerk) {
  return {.t1_s = t1_s, .t2_s = way / t1_s / acceleration, .t3_s = acceleration / jerk};
}

// A tolerance less what a chord between two samples cuts off a bend where one block brakes and the next one speeds up:
// corners are to be met by the samples. Not as printed.
double within_chords(double tolerance, double acceleration, const SmoothingOptions& options) {
  if (options.method == Method::paper_as_printed) return tolerance;
  const double loss = 2.0 * acceleration * options.sample_period_s * options.sample_period_s / 8.0;
  return std::max(0.5 * tolerance, tolerance - loss);
}

struct FirPlanner {
  const program::Program& program;
  const robot::Kinematics& kinematics;
  const Posture& posture;
  const SmoothingOptions& options;
  std::vector<FirBlock> blocks = {};
  std::vector<robot::JointJet> joints = {};
  robot::Position6 near = robot::Position6::Zero();
  double gamma_rad = 0.0;  // where the block before ended
  double tip_tolerance_m = 0.0, axis_tolerance_rad = 0.0;
  double sum_t2_s = 0.0, largest_overlap_s = 0.0;

  void constants(std::size_t i);
  double overlap(std::size_t before, std::size_t after) const;
  void schedule();
};

void FirPlanner::constants(std::size_t i) {
  const Block& block = program.blocks[i];
  const Pose& begin = program.begin_of(i);
  const bool printed = options.method == Method::paper_as_printed;
  const double length = (block.end.tip_m - begin.tip_m).norm();
  const double angle = program::angle_between(begin.axis, block.end.axis);
  if (block.kind == Block::Kind::dwell || (length == 0.0 && angle == 0.0)) return;
  if (angle > std::numbers::pi - half_turn_margin_rad) {
    throw InvalidInput("block " + std::to_string(i + 1) + " (line " + std::to_string(block.line) + ")",
                       "the axis turns by half a circle, which has no one way");
  }
  const double timed = printed ? std::acos(std::min(1.0, std::abs(begin.axis.dot(block.end.axis)))) : angle;
  const double programmed = block.kind == Block::Kind::feed ? block.duration_s : 0.0;
  const double tip_t1 = std::max(programmed, length / options.max_velocity_m_per_s);
  const double axis_t1 = std::max(programmed, timed / options.max_angular_velocity_rad_per_s);
  const double t1 = printed && length > 0.0 ? tip_t1 : std::max(tip_t1, axis_t1);
  const FirConstants tip = constants_of(length, t1, options.max_acceleration_m_per_s2, options.max_jerk_m_per_s3);
  const double own_t1 = printed && timed > 0.0 ? axis_t1 : t1;
  const FirConstants axis =
      constants_of(timed, own_t1, options.max_angular_acceleration_rad_per_s2, options.max_angular_jerk_rad_per_s3);
  FirConstants shared = tip;
  if (!printed || length == 0.0) {  // the larger of what tip and axis ask for
    shared = {.t1_s = t1, .t2_s = std::max(tip.t2_s, axis.t2_s), .t3_s = std::max(tip.t3_s, axis.t3_s)};
  }
  const FirWay way = {.begin = begin,
                      .end = block.end,
                      .gamma_begin_rad = gamma_rad,
                      .gamma_end_rad = gamma_at_boundary(posture.gamma_rad, i + 1)};
  gamma_rad = way.gamma_end_rad;
  const Reach reach = joints_along(kinematics, way, near, joints);
  if (reach.status != Reach::Status::found) reject(program, i, reach);
  // As printed the joints' derivatives are those by the tip's way, which a pure rotation does not have.
  if (!printed || length > 0.0) {
    stretch_for_joints(joints, kinematics.limits(), kinematics.joints(), options, shared);
  }
  blocks[i].tip = blocks[i].axis = boxes_of(shared, options.filters);
  sum_t2_s += shared.t2_s;
  if (!printed || length == 0.0 || timed < 1e-7) return;
  // As printed: constants of their own, and the same total by T1 alone.
  blocks[i].axis = boxes_of(axis, options.filters);
  const double wait = blocks[i].tip.sum_s() - blocks[i].axis.sum_s();
  (wait > 0.0 ? blocks[i].axis : blocks[i].tip).width_s[0] += std::abs(wait);
}

double FirPlanner::overlap(std::size_t before, std::size_t after) const {
  const bool printed = options.method == Method::paper_as_printed;
  const Pose &from = program.begin_of(before), &corner = program.begin_of(after), &to = program.blocks[after].end;
  const Boxes &tip = blocks[before].tip, &next_tip = blocks[after].tip;
  const Boxes &axis = blocks[before].axis, &next_axis = blocks[after].axis;
  const Vector3d v = (corner.tip_m - from.tip_m) / tip.width_s[0];
  const Vector3d next_v = (to.tip_m - corner.tip_m) / next_tip.width_s[0];
  const Block &block = program.blocks[before], &next = program.blocks[after];
  const double tip_left_m = std::max(0.0, tip_tolerance_m - std::max(block.tip_deviation_m, next.tip_deviation_m));
  const double axis_left_rad =
      std::max(0.0, axis_tolerance_rad - std::max(block.axis_deviation_rad, next.axis_deviation_rad));
  const double tip_s = largest_overlap_s_of(tip, next_tip, corner_speed(v, next_v, printed), tip_left_m);
  const Vector3d w = end_tangent(from.axis, corner.axis) / axis.width_s[0];
  const Vector3d next_w = -end_tangent(to.axis, corner.axis) / next_axis.width_s[0];
  const double axis_s = largest_overlap_s_of(axis, next_axis, corner_speed(w, next_w, printed), axis_left_rad);
  return std::min(tip_s, axis_s);
}

void FirPlanner::schedule() {
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  double done = 0.0;
  std::size_t before = none;  // the block that the next one may overlap with
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    FirBlock& block = blocks[i];
    block.start_s = block.end_s = done;
    if (program.blocks[i].kind == Block::Kind::dwell) {
      block.end_s = done = done + program.blocks[i].duration_s;
      before = none;
      continue;
    }
    if (block.tip.count == 0) {  // in order of start, though it takes no time
      if (before != none) block.start_s = block.end_s = blocks[before].start_s;
      continue;
    }
    if (before != none) {
      const double shared = overlap(before, i);
      blocks[before].overlap_s = shared;
      block.start_s = blocks[before].end_s - shared;
      largest_overlap_s = std::max(largest_overlap_s, shared);
    }
    block.end_s = block.start_s + std::max(block.tip.sum_s(), block.axis.sum_s());
    done = std::max(done, block.end_s);
    before = i;
  }
}

void validate(const program::Program& program, const Posture& posture, const SmoothingOptions& options) {
  options.validate();
  if (options.method == Method::verified || options.method == Method::optimal) {
    throw InvalidInput("method", "must be one of the FIR methods");
  }
  const std::size_t gammas = posture.gamma_rad.size();
  if (gammas > 1 && gammas != program.blocks.size() + 1) {
    throw InvalidInput("gamma_rad", static_cast<double>(gammas), "",
                       "must hold none, one, or one more than the program has blocks");
  }
}

}  // namespace

FirPlan plan_fir(const program::Program& program, const robot::Kinematics& kinematics, const Posture& posture,
                 const SmoothingOptions& options) {
  validate(program, posture, options);
  FirPlanner planner = {.program = program, .kinematics = kinematics, .posture = posture, .options = options};
  planner.blocks.resize(program.blocks.size());
  planner.near = posture.start;
  planner.gamma_rad = gamma_at_boundary(posture.gamma_rad, 0);
  planner.tip_tolerance_m = within_chords(options.tip_tolerance_m, options.max_acceleration_m_per_s2, options);
  planner.axis_tolerance_rad =
      within_chords(options.axis_tolerance_rad, options.max_angular_acceleration_rad_per_s2, options);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) planner.constants(i);
  planner.schedule();
  FirPlan plan;
  plan.trajectory = FirTrajectory(program, std::move(planner.blocks), posture.gamma_rad);
  plan.duration_s = plan.trajectory.duration_s();
  plan.sum_t2_s = planner.sum_t2_s;
  plan.largest_overlap_s = planner.largest_overlap_s;
  return plan;
}

std::size_t sample_fir(const FirPlan& plan, const program::Program& program, const robot::Kinematics& kinematics,
                       const Posture& posture, double sample_period_s, const SampleSink& sink) {
  require_positive("sample_period_s", sample_period_s, "s");
  const auto last = static_cast<std::size_t>(std::ceil(plan.duration_s / sample_period_s - 1e-9));
  std::array<Sample, 256> chunk;
  std::size_t filled = 0;
  robot::Position6 near = posture.start;
  for (std::size_t i = 0; i <= last; ++i) {
    const double time_s = static_cast<double>(i) * sample_period_s;
    const robot::ToolJet jet = plan.trajectory.at(time_s);
    Sample& sample = chunk[filled];
    sample = {.time_s = time_s,
              .tip_m = jet.tip_m.col(0),
              .axis = jet.axis.col(0),
              .block = plan.trajectory.block_at(time_s)};
    const robot::ToolPose pose = {.tip_m = sample.tip_m, .axis = sample.axis, .gamma_rad = jet.gamma_rad[0]};
    const Reach reach = kinematics.follow(pose, near, sample.joints);
    if (reach.status != Reach::Status::found && !program.blocks.empty()) reject(program, sample.block, reach);
    near = sample.joints;
    if (++filled == chunk.size() || i == last) {
      sink(std::span<const Sample>(chunk.data(), filled));
      filled = 0;
    }
  }
  return last + 1;
}

}  // namespace robomill::path
