#include "robomill/path/speed/preview.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/path/speed/planner.hpp"

namespace robomill::path {
namespace {

/// Below what the checker allows, so that both agree.
constexpr double slack = 1.0 + 5e-7;
/// Shorter steps are rounding and have no direction [m or rad].
constexpr double standstill = 1e-13;
constexpr double cells_per_m = SpeedCorrections::cells_per_m;

}  // namespace

Preview::Preview(const robot::Kinematics& kinematics, const SmoothingOptions& options) {
  const robot::JointLimits& limits = kinematics.limits();
  const double h = options.sample_period_s;
  period_s_ = h;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const bool moves = row < kinematics.joints();
    most_[0][k] = moves ? limits.max_velocity[row] : 1.0;
    most_[1][k] = moves ? limits.max_acceleration[row] : 1.0;
    most_[2][k] = moves ? limits.max_jerk[row] : 1.0;
  }
  most_[0][6] = options.max_velocity_m_per_s;
  most_[1][6] = options.max_acceleration_m_per_s2;
  most_[2][6] = options.max_jerk_m_per_s3;
  most_[0][7] = options.max_angular_velocity_rad_per_s;
  most_[1][7] = options.max_angular_acceleration_rad_per_s2;
  most_[2][7] = options.max_angular_jerk_rad_per_s3;
  for (std::size_t k = 0; k < channels; ++k) {
    most_[0][k] *= h;
    most_[1][k] *= h * h;
    most_[2][k] *= h * h * h;
  }
}

Preview::Row Preview::step_to(const Trail& trail, const Sample& sample) {
  Row step = Row::Zero();
  if (!trail.begun) return step;
  step.head<6>() = sample.joints - trail.joints;
  step.segment<3>(6) = sample.tip_m - trail.tip_m;
  // The rotation: a difference of unit vectors would bend with their sphere.
  step.tail<3>() = trail.axis.cross(sample.axis);
  return step;
}

void Preview::follow(Trail& trail, const Sample& sample, const Row& step) {
  trail = {.joints = sample.joints,
           .tip_m = sample.tip_m,
           .axis = sample.axis,
           .step = step,
           .step_before = trail.step,
           .tip_feed_m = trail.tip_feed_m,
           .begun = true};
}

void Preview::pass(std::span<const Sample> samples) {
  for (const Sample& sample : samples.last(std::min<std::size_t>(samples.size(), 3))) {
    follow(trail_, sample, step_to(trail_, sample));
  }
}

void Preview::note(double value, double most, int order, double path_m, std::vector<Violation>& violations) {
  if (value <= most * slack) return;
  const double cell = std::floor(path_m * cells_per_m), ratio = value / most;
  Violation& last = last_[static_cast<std::size_t>(order - 1)];
  // Violations of a place come in a row: the first of each row stands in the book, with the worst of it.
  if (last.order == order && std::floor(last.path_m * cells_per_m) == cell) {
    last.ratio = std::max(last.ratio, ratio);
    return;
  }
  if (last.order == order) violations.push_back(last);
  last = {.path_m = path_m, .ratio = ratio, .order = order};
}

void Preview::differences(const Trail& trail, const Row& step, double path_m, std::vector<Violation>& violations) {
  using Joints = Eigen::Array<double, 6, 1>;
  const Row second = step - trail.step, third = second - (trail.step - trail.step_before);
  const auto beyond = [&](const Row& difference, std::size_t order) {
    return (difference.head<6>().array().abs() > Eigen::Map<const Joints>(most_[order - 1].data())).any();
  };
  if (beyond(step, 1) || beyond(second, 2) || beyond(third, 3)) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      note(std::abs(step[row]), most_[0][k], 1, path_m, violations);
      note(std::abs(second[row]), most_[1][k], 2, path_m, violations);
      note(std::abs(third[row]), most_[2][k], 3, path_m, violations);
    }
  }
  for (std::size_t k = 6; k < channels; ++k) {
    const Eigen::Index row = k == 6 ? 6 : 9;
    const double speed = step.segment<3>(row).norm(), before = trail.step.segment<3>(row).norm();
    note(speed, most_[0][k], 1, path_m, violations);
    note(std::abs(speed - before), most_[1][k], 2, path_m, violations);
    if (before > standstill)
      note(std::abs(third.segment<3>(row).dot(trail.step.segment<3>(row))) / before, most_[2][k], 3, path_m,
           violations);
  }
}

void Preview::look(Emitter& ahead, std::span<const Segment> motion, bool joined, std::vector<Violation>& violations) {
  last_ = {};
  Trail trail = joined ? trail_ : Trail{};
  // Third differences need four samples.
  int still_to_join = joined ? 0 : 3;
  samples_.clear();
  const auto take = [&] {
    const Sample& sample = samples_.front();
    const Row step = step_to(trail, sample);
    const double tip_feed_m = ahead.at().max_tip_m_per_s * period_s_;
    if (still_to_join > 0) {
      --still_to_join;
    } else {
      differences(trail, step, sample.path_m, violations);
      // From one block to the next the faster feed holds.
      note(step.segment<3>(6).norm(), std::max(tip_feed_m, trail.tip_feed_m), 1, sample.path_m, violations);
    }
    trail.tip_feed_m = tip_feed_m;
    follow(trail, sample, step);
    samples_.clear();
  };
  // What cannot be reached is reported when the motion is sent out.
  static_cast<void>(ahead.add({}, motion, samples_, take, 1));
  for (const Violation& last : last_) {
    if (last.ratio > 1.0) violations.push_back(last);
  }
}

}  // namespace robomill::path
