#include "robomill/path/realtime/survey.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace robomill::path {
namespace {

/// A joint that is seen to run this many times faster than it can has been put another way, not moved.
constexpr double jump_ratio = 3.0;
/// Rounding [m or rad a period]: no direction.
constexpr double no_length = 1e-13;

ChannelLimits limits_of(const robot::Kinematics& kinematics, const SmoothingOptions& options) {
  const robot::JointLimits& joints = kinematics.limits();
  ChannelLimits out;
  out.velocity.fill(1.0);
  out.acceleration.fill(1.0);
  out.jerk.fill(1.0);
  for (int j = 0; j < kinematics.joints(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    out.velocity[k] = joints.max_velocity[j];
    out.acceleration[k] = joints.max_acceleration[j];
    out.jerk[k] = joints.max_jerk[j];
  }
  out.velocity[6] = options.max_velocity_m_per_s;
  out.acceleration[6] = options.max_acceleration_m_per_s2;
  out.jerk[6] = options.max_jerk_m_per_s3;
  out.velocity[7] = options.max_angular_velocity_rad_per_s;
  out.acceleration[7] = options.max_angular_acceleration_rad_per_s2;
  out.jerk[7] = options.max_angular_jerk_rad_per_s3;
  return out;
}

/// Steps of a tip or an axis in one period each, the newest first.
struct Steps {
  Eigen::Vector3d last, middle, first;
  [[nodiscard]] Eigen::Vector3d third() const { return last - 2.0 * middle + first; }
};

/// The largest component of a vector along any direction between two steps: of itself in their plane where that lies
/// between them, or opposite.
double largest_along(const Eigen::Vector3d& vector, const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
  const double aa = one.squaredNorm(), bb = other.squaredNorm(), ab = one.dot(other);
  const double va = vector.dot(one), vb = vector.dot(other);
  const double ends = std::max(std::abs(va) / std::sqrt(aa), std::abs(vb) / std::sqrt(bb));
  // vector = α one + β other + what is across their plane.
  const double alpha = va * bb - vb * ab, beta = vb * aa - va * ab, square = aa * bb - ab * ab;
  if (!(alpha * beta > 0.0) || !(square > 1e-12 * aa * bb)) return ends;
  return std::max(ends, std::sqrt(std::max(0.0, (alpha * va + beta * vb) / square)));
}

/// Speed, its rate and the jerk along the path, whenever within the last half of a period the samples are taken: at a
/// reversal the direction sweeps past in less than that.
void along(const Steps& now, const Steps& before, double rate, std::size_t channel, Demand& out) {
  const double speed = now.last.norm(), middle = now.middle.norm();
  const Eigen::Vector3d second = now.last - now.middle, third = now.third();
  double change = std::abs(speed - middle), jerk = third.norm();
  if (middle > no_length) {
    change = std::max(change, std::abs(second.dot(now.middle)) / middle);
    if (before.middle.norm() > no_length) {
      jerk = std::max(largest_along(third, now.middle, before.middle),
                      largest_along(before.third(), now.middle, before.middle));
    }
  }
  out.velocity[channel] = speed * rate;
  out.acceleration[channel] = change * rate * rate;
  out.jerk[channel] = jerk * rate * rate * rate;
}

/// The rotation between two axes that are near each other.
Eigen::Vector3d small_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  return across * (1.0 + across.squaredNorm() / 6.0);
}

}  // namespace

Survey::Survey(LookAhead& ahead, const robot::Kinematics& kinematics, const SmoothingOptions& options,
               const robot::Position6& start)
    : ahead_(ahead),
      kinematics_(kinematics),
      limits_(limits_of(kinematics, options)),
      period_s_(options.sample_period_s),
      max_slope_(0.1 / options.sample_period_s),
      near_(start) {}

bool Survey::look(double u_m) noexcept {
  while (path_at_ + 1 < ahead_.path.written() && ahead_.path.put_at(path_at_ + 1).begin_m <= u_m) ++path_at_;
  const Polynomial& here = at();
  const robot::ToolPose pose = here.pose(u_m - here.begin_m);
  robot::Position6 joints;
  reach_ = kinematics_.follow(pose, near_, joints);
  if (reach_.status != robot::Reach::Status::found) return false;
  for (int j = 0; j < kinematics_.joints() && count_ > 0; ++j) {
    const double beyond =
        std::abs(joints[j] - near_[j]) - jump_ratio * 0.5 * period_s_ * limits_.velocity[static_cast<std::size_t>(j)];
    if (beyond > 0.0) {
      reach_ = {.status = robot::Reach::Status::jump, .joint = j, .beyond = beyond};
      return false;
    }
  }
  near_ = joints;
  feeds_ = {here.max_tip_m_per_s, feeds_[0]};
  Row row;
  row << joints, pose.tip_m, pose.axis;
  record(row);
  return true;
}

Demand Survey::demand() const noexcept {
  const double rate = 1.0 / period_s_;
  Demand out;
  const Row step = rows_[0] - rows_[2], before = rows_[2] - rows_[4], first = rows_[4] - rows_[6];
  for (int j = 0; j < 6; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const double second = step[j] - before[j];
    out.velocity[k] = std::abs(step[j]) * rate;
    out.acceleration[k] = std::abs(second) * rate * rate;
    out.jerk[k] = std::abs(second - (before[j] - first[j])) * rate * rate * rate;
  }
  const auto tip = [this](std::size_t from) -> Eigen::Vector3d {
    return (rows_[from] - rows_[from + 2]).segment<3>(6);
  };
  along({tip(0), tip(2), tip(4)}, {tip(1), tip(3), tip(5)}, rate, 6, out);
  // In the half period, as samples may begin anywhere.
  out.feed = 2.0 * rate * (rows_[0] - rows_[1]).segment<3>(6).norm() / std::max(feeds_[0], feeds_[1]);
  const auto turn = [this](std::size_t from) {
    return small_rotation(rows_[from + 2].tail<3>(), rows_[from].tail<3>());
  };
  along({turn(0), turn(2), turn(4)}, {turn(1), turn(3), turn(5)}, rate, 7, out);
  return out;
}

void Survey::record(const Row& row) noexcept {
  // The sample at count_ halves of a period; what it shows lies in the three periods before it.
  if (count_ == 0) {
    rows_.fill(row);
    ++count_;
    return;
  }
  std::move_backward(rows_.begin(), rows_.end() - 1, rows_.end());
  rows_[0] = row;
  if (count_ > 1 && count_ % steps == 1) {
    if (has_before_) {
      Stretch stretch = stretch_of(before_, limits_, max_slope_);
      stretch.end_s = chain_s_ + static_cast<double>(count_ - 1 - steps) * 0.5 * period_s_;
      put(stretch);
    }
    before_ = now_;
    now_ = {};
    has_before_ = true;
  }
  const Demand shown = demand();
  now_.add(shown);
  if (has_before_ && (count_ - 1) % steps < reach_back) before_.add(shown);
  ++count_;
}

void Survey::put(const Stretch& stretch) noexcept {
  ahead_.stretches.put(stretch);
  ahead_.stretches.publish();
}

void Survey::close(double end_s) noexcept {
  // The tool stands still from here on, which is a part of its stop.
  const Row row = rows_[0];
  for (std::size_t i = 0; i < reach_back; ++i) {
    std::move_backward(rows_.begin(), rows_.end() - 1, rows_.end());
    rows_[0] = row;
    now_.add(demand());
  }
  now_.add(before_);
  Stretch stretch = stretch_of(now_, limits_, max_slope_);
  stretch.kind = Stretch::Kind::rests;
  stretch.end_s = end_s;
  put(stretch);
  before_ = now_ = {};
  has_before_ = false;
  count_ = 0;
  next_s_ = 0.0;
  chain_s_ = end_s;
}

Survey::ScanStatus Survey::take(const Segment& segment) noexcept {
  if (!begun_) {
    if (ahead_.motion.room() == 0) return ScanStatus::full;
    begin_s_ += length_s_;
    length_s_ = duration_s(segment);
    ahead_.motion.put({.segment = segment, .begin_s = begin_s_, .length_s = length_s_});
    ahead_.motion.publish();
    begun_ = true;
  }
  const double end_s = begin_s_ + length_s_;
  constexpr std::size_t spare = 2;
  if (segment.kind == Segment::Kind::dwell) {
    if (ahead_.stretches.room() < spare) return ScanStatus::full;
    put({.kind = Stretch::Kind::dwell, .end_s = end_s});
    chain_s_ = end_s;
    begun_ = false;
    return ScanStatus::on;
  }
  for (; next_s_ < length_s_; next_s_ += 0.5 * period_s_) {
    if (ahead_.stretches.room() < spare) return ScanStatus::full;
    if (!look(segment.begin_m + way_m(segment, next_s_, length_s_))) return ScanStatus::unreachable;
  }
  if (segment.kind == Segment::Kind::to_rest) {
    if (ahead_.stretches.room() < spare) return ScanStatus::full;
    if (!look(segment.begin_m + segment.length_m)) return ScanStatus::unreachable;
    close(end_s);
  } else {
    next_s_ -= length_s_;
  }
  begun_ = false;
  return ScanStatus::on;
}

}  // namespace robomill::path
