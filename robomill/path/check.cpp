#include "robomill/path/check.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/path/check/check_state.hpp"

namespace robomill::path {

using Eigen::Vector3d;

namespace {

constexpr double largest = 1e9;  // m or rad: beyond is no sample of a machine
// Speeds below this are rounding [m or rad a period]: they have no direction.
constexpr double no_step = 1e-13;

CheckRow row_of(const Sample& sample) {
  CheckRow row;
  row << sample.joints, sample.tip_m, sample.axis;
  return row;
}

bool sane(const CheckRow& row) {  // false for what is not a number
  return (row.array().abs() <= largest).all();
}

// The rotation between two axes, as a vector: its differences leave out that a unit vector bends with its sphere.
Vector3d rotation(const Vector3d& from, const Vector3d& to) {
  const Vector3d across = from.cross(to);
  const double sine = across.squaredNorm();
  if (sine < 1e-6) return across * (1.0 + sine / 6.0);
  return across * (program::angle_between(from, to) / std::sqrt(sine));
}

// Speed, its rate and the jerk along the path, each a difference.
struct Along {
  double speed, rate, jerk;
};

Along along_path(const Vector3d& step, const Vector3d& step_before, const Vector3d& step_before_that) {
  const Vector3d third = step - 2.0 * step_before + step_before_that;
  const double speed = step.norm(), speed_before = step_before.norm();
  double jerk = 0.0;
  if (speed_before > no_step) {
    jerk = std::abs(third.dot(step_before)) / speed_before;
  } else {  // the tool stands in the middle: it moves as it does before and after
    const Vector3d way = step + step_before + step_before_that;
    const double length = way.norm();
    jerk = length > no_step ? std::abs(third.dot(way)) / length : third.norm();
  }
  return {.speed = speed, .rate = std::abs(speed - speed_before), .jerk = jerk};
}

}  // namespace

void CheckOptions::validate() const {
  require_non_negative("relative_tolerance", relative_tolerance, "");
  require_positive("max_pose_error", max_pose_error, "m and rad");
}

std::size_t CheckResult::violations() const {
  std::size_t sum = faulty;
  for (const Joint& joint : joints) {
    sum +=
        joint.position.violations + joint.velocity.violations + joint.acceleration.violations + joint.jerk.violations;
  }
  for (const Usage* usage : {&tip_velocity, &tip_acceleration, &tip_jerk, &axis_velocity, &axis_acceleration,
                             &axis_jerk, &feed, &tip_error_m, &axis_error_rad, &pose_error, &dwell_s}) {
    sum += usage->violations;
  }
  return sum;
}

Checker::State::State(program::Source& source, const robot::Kinematics& machine, const SmoothingOptions& smoothing,
                      const CheckOptions& check)
    : window_(source), machine_(machine), options_(smoothing), joints_(machine.joints()) {
  result_.joints.resize(static_cast<std::size_t>(joints_));
  watch_all(check);
}

void Checker::State::watch_all(const CheckOptions& check) {
  const double slack = check.relative_tolerance;
  const robot::JointLimits& limits = machine_.limits();
  const auto kept = [&](double limit) { return check.tolerances_alone ? 0.0 : limit; };  // 0: watched without a limit
  for (int j = 0; j < joints_; ++j) {
    CheckResult::Joint& joint = result_.joints[static_cast<std::size_t>(j)];
    joint.position.max = -std::numeric_limits<double>::max();
    joint_watch_[static_cast<std::size_t>(j)] = {
        .velocity = Watch(joint.velocity, kept(limits.max_velocity[j]), slack, 1),
        .acceleration = Watch(joint.acceleration, kept(limits.max_acceleration[j]), slack, 2),
        .jerk = Watch(joint.jerk, kept(limits.max_jerk[j]), slack, 3)};
  }
  tip_velocity_ = Watch(result_.tip_velocity, kept(options_.max_velocity_m_per_s), slack, 1);
  tip_acceleration_ = Watch(result_.tip_acceleration, kept(options_.max_acceleration_m_per_s2), slack, 2);
  tip_jerk_ = Watch(result_.tip_jerk, kept(options_.max_jerk_m_per_s3), slack, 3);
  axis_velocity_ = Watch(result_.axis_velocity, kept(options_.max_angular_velocity_rad_per_s), slack, 1);
  axis_acceleration_ = Watch(result_.axis_acceleration, kept(options_.max_angular_acceleration_rad_per_s2), slack, 2);
  axis_jerk_ = Watch(result_.axis_jerk, kept(options_.max_angular_jerk_rad_per_s3), slack, 3);
  feed_ = Watch(result_.feed, kept(1.0), slack, 1);
  tip_error_ = Watch(result_.tip_error_m, options_.tip_tolerance_m, slack, 0);
  axis_error_ = Watch(result_.axis_error_rad, options_.axis_tolerance_rad, slack, 0);
  synchrony_ = Watch(result_.synchrony_rad, 0.0, slack, 0);
  pose_error_ = Watch(result_.pose_error, check.max_pose_error, slack, -1);
  dwell_ = Watch(result_.dwell_s, kept(2.0 * options_.sample_period_s), slack, -1);
}

void Checker::State::begin(const Sample& sample) {
  first_time_s_ = sample.time_s;
  time_s_ = sample.time_s;
  row_ = row_of(sample);
  tip_error_.note((sample.tip_m - window_.start().tip_m).norm(), {.time_s = sample.time_s, .block = 0}, book_);
  axis_error_.note(angle_of_chord((sample.axis - window_.start().axis).norm()), {.time_s = sample.time_s, .block = 0},
                   book_);
}

// As if the tool stood still, so that what follows can be checked.
void Checker::State::correct(Sample& sample, double due_s) const {
  const bool first = result_.samples == 1;
  sample.time_s = first ? 0.0 : due_s;
  sample.joints = row_.head<6>();
  sample.tip_m = first ? window_.start().tip_m : Vector3d(row_.segment<3>(6));
  sample.axis = first ? window_.start().axis : Vector3d(row_.tail<3>());
}

void Checker::State::add(const Sample& given) {
  Sample sample = given;
  const bool first = result_.samples == 0;
  ++result_.samples;
  const double due = time_s_ + options_.sample_period_s;
  const bool sound = sane(row_of(sample)) && std::isfinite(sample.time_s);
  bool faulty = !sound;
  if (!sound) correct(sample, due);
  if (first) {
    begin(sample);
  } else if (!(std::abs(sample.time_s - due) <= 1e-6 * options_.sample_period_s + 1e-12 * std::abs(due))) {
    faulty = true;
  }
  time_s_ = last_time_s_ = sample.time_s;
  book_.at(sample.path_m);
  block_before_ = block_;
  const CheckRow row = row_of(sample);
  CheckRow step = row - row_;
  const Vector3d tip_from = row_.segment<3>(6), axis_from = row_.tail<3>();
  const Vector3d tip_step = step.segment<3>(6), axis_step = step.tail<3>();
  tip_travelled_ += tip_step.norm();
  axis_travelled_ += axis_step.norm();
  row_ = row;
  advance(sample.block);
  if (sample.block >= window_.high() && sample.block > 0) faulty = true;
  block_ = std::min(std::max(sample.block, window_.low()), window_.high() == 0 ? 0 : window_.high() - 1);
  if (first) block_before_ = block_;
  if (faulty) {
    ++result_.faulty;
    book_.add({.time_s = sample.time_s, .block = block_}, -1, std::numeric_limits<double>::infinity());
  }
  step.tail<3>() = rotation(axis_from, sample.axis);
  differences(step);
  feed(tip_step, axis_step);
  corners(tip_from, sample.tip_m, axis_from, sample.axis);
  stand(tip_step, axis_step);
  if (sound) {
    positions(sample);
    errors(sample);
  }
  close_old();
}

void Checker::State::differences(const CheckRow& step) {
  const double h = options_.sample_period_s;
  const double rate = 1.0 / h, rate_2 = rate * rate, rate_3 = rate_2 * rate;
  const CheckRow second = step - step_;
  const CheckRow third = second - (step_ - step_before_);
  const auto place = [this, h](double periods_ago, std::size_t block) {
    return Place{.time_s = std::clamp(time_s_ - periods_ago * h, first_time_s_, last_time_s_), .block = block};
  };
  const Place now = place(0.5, block_), one_ago = place(1.0, block_before_), further = place(1.5, block_before_);
  for (int j = 0; j < joints_; ++j) {
    JointWatch& watch = joint_watch_[static_cast<std::size_t>(j)];
    watch.velocity.note(std::abs(step[j]) * rate, now, book_);
    watch.acceleration.note(std::abs(second[j]) * rate_2, one_ago, book_);
    watch.jerk.note(std::abs(third[j]) * rate_3, further, book_);
  }
  const Along tip = along_path(step.segment<3>(6), step_.segment<3>(6), step_before_.segment<3>(6));
  tip_velocity_.note(tip.speed * rate, now, book_);
  tip_acceleration_.note(tip.rate * rate_2, one_ago, book_);
  tip_jerk_.note(tip.jerk * rate_3, further, book_);
  const Along axis = along_path(step.tail<3>(), step_.tail<3>(), step_before_.tail<3>());
  axis_velocity_.note(axis.speed * rate, now, book_);
  axis_acceleration_.note(axis.rate * rate_2, one_ago, book_);
  axis_jerk_.note(axis.jerk * rate_3, further, book_);
  step_before_ = step_;
  step_ = step;
}

void Checker::State::positions(const Sample& sample) {
  const robot::JointLimits& limits = machine_.limits();
  const Place place = {.time_s = sample.time_s, .block = block_};
  for (int j = 0; j < joints_; ++j) {
    Usage& usage = result_.joints[static_cast<std::size_t>(j)].position;
    const double beyond =
        std::max(limits.min_position[j] - sample.joints[j], sample.joints[j] - limits.max_position[j]);
    if (beyond > usage.max) {
      usage.max = beyond;
      usage.at_s = place.time_s;
      usage.block = block_;
    }
    if (beyond > 0.0) {
      ++usage.violations;
      book_.add(place, -1, 1.0 + beyond / (limits.max_position[j] - limits.min_position[j]));
    }
  }
  const robot::ToolPose pose = machine_.forward(sample.joints);
  const double error = std::max((pose.tip_m - sample.tip_m).norm(), (pose.axis - sample.axis).norm());
  pose_error_.note(std::isfinite(error) ? error : largest, place, book_);
}

void Checker::State::end_at_rest() {
  for (int i = 0; i < 3; ++i) {
    time_s_ += options_.sample_period_s;
    block_before_ = block_;
    differences(CheckRow::Zero());
  }
}

CheckResult Checker::State::finish() {
  if (result_.samples == 0) {
    row_.segment<3>(6) = window_.start().tip_m;
    row_.tail<3>() = window_.start().axis;
    for (CheckResult::Joint& joint : result_.joints) joint.position.max = 0.0;
  }
  end_at_rest();
  const Vector3d tip = row_.segment<3>(6), axis = row_.tail<3>();
  while (open_ < window_.high() || read()) {
    Corner& corner = window_.corner(open_);
    if (corner.tip.best == never) {
      pass(corner.tip, window_.segment(open_).tip_end_m, tip, tip, tip_travelled_, 0.0, last_time_s_);
      pass(corner.axis, window_.segment(open_).axis_end, axis, axis, axis_travelled_, 0.0, last_time_s_);
    }
    close();
  }
  const Place end = {.time_s = last_time_s_, .block = block_};
  tip_error_.note((tip - window_.end().tip_m).norm(), end, book_);
  axis_error_.note(angle_of_chord((axis - window_.end().axis).norm()), end, book_);
  result_.duration_s = last_time_s_ - first_time_s_;
  result_.worst_violations = book_.take();
  return std::move(result_);
}

Checker::Checker(program::Source& source, const robot::Kinematics& kinematics, const SmoothingOptions& options,
                 const CheckOptions& check) {
  options.validate();
  check.validate();
  state_ = std::make_unique<State>(source, kinematics, options, check);
}

Checker::~Checker() = default;

void Checker::add(std::span<const Sample> samples) {
  for (const Sample& sample : samples) state_->add(sample);
}

CheckResult Checker::finish() {
  return state_->finish();
}

}  // namespace robomill::path
