#include "robomill/path/files/robot_programs/joint_run.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "robomill/path/check.hpp"

namespace robomill::path {
namespace {

using robot::Position6;

constexpr std::size_t least_looks = 8;

/// Slope in the middle one of three points: that of the parabola through them.
Position6 slope(const Position6& before, const Position6& at, const Position6& after, double to, double on) {
  return ((at - before) / to * on + (after - at) / on * to) / (to + on);
}

/// A cubic from one value and slope to another.
Position6 hermite(const Position6& from, const Position6& to, const Position6& slope_from, const Position6& slope_to,
                  double length, double share) {
  const double s = share, r = 1.0 - share;
  return r * r * (1.0 + 2.0 * s) * from + s * s * (3.0 - 2.0 * s) * to +
         length * s * r * (r * slope_from - s * slope_to);
}

/// The parabola that rounds the corner `at` from the middle of the line before to that of the line after.
/// @param time  since the first middle
Position6 rounded(const Position6& before, const Position6& at, const Position6& after, double to, double on,
                  double time) {
  const double u = 2.0 * time / (to + std::sqrt(to * to + 2.0 * (on - to) * time));
  const Position6 first = 0.5 * (before + at), last = 0.5 * (at + after);
  return (1.0 - u) * (1.0 - u) * first + 2.0 * u * (1.0 - u) * at + u * u * last;
}

/// The trajectory's joints between samples.
Position6 between(SampleSpool& samples, std::size_t sample, double share) {
  Position6 from = samples.row(sample).position();
  if (share == 0.0) return from;
  const Position6 to = samples.row(sample + 1).position();
  const Position6 before = sample > 0 ? samples.row(sample - 1).position() : from;
  const Position6 after = sample + 2 < samples.size() ? samples.row(sample + 2).position() : to;
  return hermite(from, to, 0.5 * (to - before), 0.5 * (after - from), 1.0, share);
}

/// One pass over all steps.
class Follow {
 public:
  Follow(const JointPoints& points, Joining joining, SampleSpool& samples, program::Source& program,
         const robot::Kinematics& machine, const SmoothingOptions& options)
      : points_(points),
        joining_(joining),
        samples_(samples),
        machine_(machine),
        options_(options),
        checker_(program, machine, options, {.tolerances_alone = true}) {}

  /// @return whether it stays by the trajectory
  bool step(std::size_t index) {
    const JointStep step = points_.step(samples_, index);
    const std::size_t from = points_.at[index], length = points_.at[index + 1] - from;
    const std::size_t parts = (least_looks + length - 1) / length;  // of a sample
    const auto looks = static_cast<double>(length * parts);
    RunDistances met;
    if (index == 0) check(0, step.at(joining_, 0.0), index);
    for (std::size_t look = 1; look <= length * parts; ++look) {
      const Position6 joints = step.at(joining_, static_cast<double>(look) / looks);
      const std::size_t sample = from + look / parts;
      const Position6 meant = between(samples_, sample, static_cast<double>(look % parts) / static_cast<double>(parts));
      const robot::ToolPose is = machine_.forward(joints), ought = machine_.forward(meant);
      met.joint_deviation_rad = std::max(met.joint_deviation_rad, (joints - meant).cwiseAbs().maxCoeff());
      met.tip_deviation_m = std::max(met.tip_deviation_m, (is.tip_m - ought.tip_m).norm());
      met.axis_deviation_rad = std::max(met.axis_deviation_rad, program::angle_between(is.axis, ought.axis));
      if (look % parts == 0) check(sample, joints, index);
    }
    const double widened = looks * looks / (looks * looks - 1.0);
    met.joint_deviation_rad *= widened;
    met.tip_deviation_m *= widened;
    met.axis_deviation_rad *= widened;
    total_.include(met);
    return met.tip_deviation_m <= options_.tip_tolerance_m && met.axis_deviation_rad <= options_.axis_tolerance_rad;
  }

  /// Marks steps that leave the program.
  RunDistances finish(std::vector<bool>& beyond) {
    const CheckResult result = checker_.finish();
    total_.tip_error_m = result.tip_error_m.max;
    total_.axis_error_rad = result.axis_error_rad.max;
    for (const Violation& violation : result.worst_violations) {
      if (violation.order == 0) mark(beyond, violation.time_s);
    }
    return total_;
  }

 private:
  /// Marks the steps of the samples around a time: a corner that is missed is reported where the tool is nearest to it,
  /// which may be at the end of the step before the one that cuts it.
  void mark(std::vector<bool>& beyond, double time_s) const {
    const double sample = std::round(time_s / options_.sample_period_s);
    const auto from = static_cast<std::size_t>(std::max(0.0, sample - 1.0)), to = static_cast<std::size_t>(sample) + 1;
    const auto step = std::upper_bound(points_.at.begin() + 1, points_.at.end() - 1, from) - 1;
    for (auto i = static_cast<std::size_t>(step - points_.at.begin()); i < beyond.size() && points_.at[i] < to; ++i) {
      beyond[i] = true;
    }
  }

  void check(std::size_t sample, const Position6& joints, std::size_t index) {
    const robot::ToolPose pose = machine_.forward(joints);
    Sample out;
    out.time_s = static_cast<double>(sample) * options_.sample_period_s;
    out.joints = joints;
    out.tip_m = pose.tip_m;
    out.axis = pose.axis;
    out.block = samples_.row(sample).block;
    out.path_m = (static_cast<double>(index) + 0.5) / violation_cells_per_m;  // keeps violations of steps apart
    checker_.add(std::span(&out, 1));
  }

  const JointPoints& points_;
  Joining joining_;
  SampleSpool& samples_;
  const robot::Kinematics& machine_;
  const SmoothingOptions& options_;
  Checker checker_;
  RunDistances total_;
};

}  // namespace

Position6 JointStep::at(Joining joining, double share) const {
  const auto& [before, from, to, after] = points;
  const auto& [length_to, length, length_on] = lengths;
  if (joining == Joining::spline) {
    const Position6 zero = Position6::Zero();
    const Position6 slope_from = from_rests ? zero : slope(before, from, to, length_to, length);
    const Position6 slope_to = to_rests ? zero : slope(from, to, after, length, length_on);
    return hermite(from, to, slope_from, slope_to, length, share);
  }
  if (joining == Joining::zone && share <= 0.5 && !from_rests) {
    return rounded(before, from, to, length_to, length, 0.5 * length_to + share * length);
  }
  if (joining == Joining::zone && share > 0.5 && !to_rests) {
    return rounded(from, to, after, length, length_on, (share - 0.5) * length);
  }
  return from + share * (to - from);
}

bool JointPoints::rests(std::size_t point) const {
  return point == 0 || point == steps() || still[point - 1] || still[point];
}

JointStep JointPoints::step(SampleSpool& samples, std::size_t index) const {
  JointStep out;
  out.from_rests = rests(index);
  out.to_rests = rests(index + 1);
  std::size_t last = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t sample = at[std::clamp<std::size_t>(index + i, 1, at.size()) - 1];
    out.points[i] = held(samples.row(sample).position());
    if (i > 0) out.lengths[i - 1] = static_cast<double>(sample - last);
    last = sample;
  }
  return out;
}

RunDistances follow_points(const JointPoints& points, Joining joining, SampleSpool& samples, program::Source& program,
                           const robot::Kinematics& machine, const SmoothingOptions& options, std::vector<bool>& beyond,
                           const Progress& progress) {
  if (points.steps() == 0) return {};  // the trajectory is one sample: nothing moves
  program.rewind();
  Follow follow(points, joining, samples, program, machine, options);
  for (std::size_t index = 0; index < points.steps(); ++index) {
    if (!follow.step(index)) beyond[index] = true;
    if (index % 1024 == 0) progress.check();
  }
  return follow.finish(beyond);
}

}  // namespace robomill::path
