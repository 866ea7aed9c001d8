#include "robomill/path/speed/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/path/speed/feed_override.hpp"

namespace robomill::path {
namespace {

/// How fast segments may grow away from a corner.
constexpr double growth = 0.5;
/// Nodes that fit beyond the look-ahead: what a corner's filters reach, and the pieces of one block.
constexpr std::size_t spare_nodes = 4 * Blend::max_reach + 64;

ChannelLimits channel_limits(const robot::Kinematics& kinematics, const SmoothingOptions& options,
                             const PlannerOptions& planner) {
  const robot::JointLimits& joints = kinematics.limits();
  ChannelLimits out;
  for (std::size_t k = 0; k < 6; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const bool moves = row < kinematics.joints();
    out.velocity[k] = moves ? joints.max_velocity[row] : 1.0;
    out.acceleration[k] = moves ? joints.max_acceleration[row] : 1.0;
    out.jerk[k] = moves ? joints.max_jerk[row] : 1.0;
  }
  out.velocity[6] = options.max_velocity_m_per_s;
  out.acceleration[6] = options.max_acceleration_m_per_s2;
  out.jerk[6] = options.max_jerk_m_per_s3;
  out.velocity[7] = options.max_angular_velocity_rad_per_s;
  out.acceleration[7] = options.max_angular_acceleration_rad_per_s2;
  out.jerk[7] = options.max_angular_jerk_rad_per_s3;
  const double share = planner.share;
  for (std::size_t k = 0; k < channel_count; ++k) {
    out.velocity[k] *= share;
    out.acceleration[k] *= share * share * planner.acceleration_share;
    out.jerk[k] *= share * share * share * planner.jerk_share;
  }
  return out;
}

/// Derivatives along the direction of motion.
void project(const Eigen::Matrix<double, 3, 4>& jet, std::size_t channel, PathPoint& out) {
  for (int order = 1; order < 4; ++order) {
    const double length = jet.col(order).norm();
    if (!(length > 1e-12)) continue;
    const Eigen::Vector3d along = jet.col(order) / length;
    out.c1[channel] = along.dot(jet.col(1));
    out.c2[channel] = along.dot(jet.col(2));
    out.c3[channel] = along.dot(jet.col(3));
    return;
  }
}

Planner::Status::Kind kind_of(robot::Reach::Status status) {
  switch (status) {
    case robot::Reach::Status::found:
      return Planner::Status::Kind::ok;
    case robot::Reach::Status::out_of_reach:
      return Planner::Status::Kind::out_of_reach;
    case robot::Reach::Status::outside_limits:
      return Planner::Status::Kind::outside_limits;
    case robot::Reach::Status::singular:
      return Planner::Status::Kind::singular;
    case robot::Reach::Status::jump:
      break;
  }
  return Planner::Status::Kind::jump;
}

Planner::Status status_of(const robot::Reach& reach, const Polynomial& where) {
  return {.kind = kind_of(reach.status), .block = where.block, .line = where.line, .reach = reach};
}

}  // namespace

PlannerOptions PlannerOptions::optimal() {
  return {.window = 20000,
          .commit = 16000,
          .look_ahead = 4096,
          .spacing = 0.25,
          .speed = {.relative_gap = 1e-4, .max_iterations = 200},
          .local_slow_down = false};
}

PlannerOptions PlannerOptions::real_time() {
  return {.window = 240, .commit = 60, .look_ahead = 128};
}

PlannerOptions PlannerOptions::interpolated() {
  PlannerOptions out = real_time();
  // Below the shares of feed_override.hpp by what samples may show beyond the planner's derivatives.
  out.acceleration_share = 0.975 * override_limits::alpha;
  out.jerk_share = 0.95 * override_limits::beta;
  // Nothing is planned again where a corner comes out wider than its nodes and middles say.
  out.tolerance_share = 0.9;
  return out;
}

/// A row's, and where the tool rests.
std::size_t Planner::row_points() const noexcept {
  return point_count * (planner_.window + 8) + 2;
}

Planner::Planner(const robot::Kinematics& kinematics, const SmoothingOptions& options, const PlannerOptions& planner,
                 const SpeedCorrections* corrections, Task task)
    : kinematics_(kinematics),
      planner_(planner),
      corrections_(corrections),
      task_(task),
      limits_((options.validate(), kinematics.limits().validate(kinematics.joints()),
               channel_limits(kinematics, options, planner))),
      blend_(options, planner.look_ahead + spare_nodes),
      solver_(limits_, planner.window + 8) {
  const double v = options.max_velocity_m_per_s, a = options.max_acceleration_m_per_s2, j = options.max_jerk_m_per_s3;
  // Not below what passes in a few samples, however stiff the limits.
  largest_segment_m_ = std::max(0.3 * planner.spacing * v * v / a, 3.0 * v * options.sample_period_s);
  axis_weight_m_ = j / options.max_angular_jerk_rad_per_s3;
  rest_m_ = std::clamp(0.25 * a * a * a / (6.0 * j * j), 1e-3 * largest_segment_m_, largest_segment_m_);
  // A corner has two knots (four with three filters) beside its node.
  path_capacity_ = (planner.look_ahead + spare_nodes) * (options.filters == 2 ? 3 : 5) + 8;
  ahead_.reserve(2 * path_capacity_);
  path_.reserve(path_capacity_);
  row_.reserve(planner.window + 8);
  begin_m_.reserve(planner.window + 8);
  before_.reserve(planner.window + 8);
  motion_.reserve(motion_capacity());
  if (task == Task::points) points_.reserve(2 * row_points());
}

Planner::Status Planner::begin(const program::Pose& pose, double gamma_rad, const robot::Position6& start) noexcept {
  blend_.begin(pose, gamma_rad);
  ahead_.clear();
  row_.clear();
  begin_m_.clear();
  motion_.clear();
  path_.clear();
  points_.clear();
  ahead_at_ = pieces_taken_ = near_node_ = frozen_ = safe_to_ = 0;
  u_m_ = chain_begin_m_ = waiting_s_ = 0.0;
  resting_ = true;
  busy_ = proposed_ = false;
  const robot::ToolPose tool{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = gamma_rad};
  const robot::Reach reach = kinematics_.follow(tool, start, near_);
  return {.kind = kind_of(reach.status), .reach = reach};
}

Planner::Status Planner::push(const program::Block& block, std::size_t index, double gamma_rad) noexcept {
  if (busy_) return {.kind = Status::Kind::full, .block = index, .line = block.line};
  if (block.kind == program::Block::Kind::dwell) {
    if (idle()) {
      waiting_s_ += block.duration_s;
      return {};
    }
    blend_.stop(block.duration_s);
    return advance();
  }
  if (blend_.room() < spare_nodes / 2) return {.kind = Status::Kind::full, .block = index, .line = block.line};
  double tolerance = planner_.tolerance_share;
  if (corrections_ != nullptr) {
    const auto correct = corrections_->tolerance.find(index);
    if (correct != corrections_->tolerance.end()) tolerance = correct->second;
  }
  switch (blend_.add(block, index, gamma_rad, tolerance)) {
    case Blend::Added::antipodal:
      return {.kind = Status::Kind::antipodal, .block = index, .line = block.line};
    case Blend::Added::full:
      return {.kind = Status::Kind::full, .block = index, .line = block.line};
    case Blend::Added::nothing:
      return {};
    case Blend::Added::moved:
      break;
  }
  return blend_.room() < spare_nodes ? advance() : Status{};
}

bool Planner::idle() const noexcept {
  return resting_ && ahead_.empty() && pieces_taken_ + 1 == blend_.end();
}

void Planner::wait() noexcept {
  if (waiting_s_ > 0.0) motion_.push_back({.kind = Segment::Kind::dwell, .begin_m = u_m_, .dwell_s = waiting_s_});
  waiting_s_ = 0.0;
}

Planner::Status Planner::finish() noexcept {
  if (idle()) {
    // A dwell without any path has no place.
    if (u_m_ > 0.0) wait();
    return {};
  }
  blend_.stop(0.0);
  return advance();
}

Planner::Status Planner::resume() noexcept {
  if (proposed_) take_over();
  proposed_ = false;
  return lay_segments();
}

Planner::Status Planner::advance() noexcept {
  blend_.find_widths();
  take_polynomials();
  return lay_segments();
}

void Planner::take_polynomials() noexcept {
  std::array<Polynomial, Blend::max_polynomials> some;
  for (; pieces_taken_ < blend_.ready(); ++pieces_taken_) {
    const std::size_t count = blend_.polynomials(pieces_taken_, some.data());
    ahead_.insert(ahead_.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
    path_.insert(path_.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  }
}

double Planner::spacing_m(double u_m) noexcept {
  while (near_node_ + 1 < blend_.end() && blend_.node(near_node_ + 1).u_m <= u_m) ++near_node_;
  double out = largest_segment_m_;
  const auto meet = [&](const Blend::Node& corner) {
    if (corner.stop || corner.step.squaredNorm() < 1e-16) return;
    const double gap = std::max(0.0, std::abs(u_m - corner.u_m) - corner.half_width_m);
    // Towards a corner the segment itself shortens the gap.
    const double rate = u_m < corner.u_m ? growth / (1.0 + growth) : growth;
    out = std::min(out, planner_.spacing * corner.half_width_m + rate * gap);
  };
  const double reach_m = blend_.max_half_width_m() + largest_segment_m_ / growth;
  for (std::size_t k = near_node_ + 1; k > blend_.first() && u_m - blend_.node(k - 1).u_m < reach_m;) {
    meet(blend_.node(--k));
    if (blend_.node(k).stop) break;
  }
  for (std::size_t k = near_node_ + 1; k < blend_.ready() && blend_.node(k).u_m - u_m < reach_m; ++k) {
    meet(blend_.node(k));
    if (blend_.node(k).stop) break;
  }
  return out;
}

double Planner::snapped_m(double length_m) const noexcept {
  // Third derivatives step where polynomials join: where they do so in earnest a segment should end.
  for (std::size_t i = ahead_at_ + 1; i < ahead_.size(); ++i) {
    const double at_m = ahead_[i].begin_m - u_m_;
    if (at_m > 1.4 * length_m) break;
    if (at_m < 0.3 * length_m) continue;
    const Blend::Point before = ahead_[i - 1].coefficients.col(3), after = ahead_[i].coefficients.col(3);
    const Eigen::Vector3d tip_step = (after - before).head<3>(), axis_step = (after - before).segment<3>(3);
    if (tip_step.norm() > 0.2 * (before.head<3>().norm() + after.head<3>().norm()) ||
        axis_step.norm() > 0.2 * (before.segment<3>(3).norm() + after.segment<3>(3).norm())) {
      return at_m;
    }
  }
  return length_m;
}

Planner::Status Planner::look_at(const Polynomial& polynomial, double x_m, PathPoint& out,
                                 robot::JointJet& joints) noexcept {
  const robot::ToolJet tool = polynomial.jet(x_m);
  const robot::Reach reach = kinematics_.follow(tool, near_, joints);
  if (reach.status != robot::Reach::Status::found) return status_of(reach, polynomial);
  out.c1 = out.c2 = out.c3 = {};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    out.c1[k] = joints(row, 1);
    out.c2[k] = joints(row, 2);
    out.c3[k] = joints(row, 3);
  }
  project(tool.tip_m, 6, out);
  project(tool.axis, 7, out);
  return {};
}

double Planner::middle_share(double length_m) const noexcept {
  // The middle, or the steeper side of the largest step of third derivatives that the segment could not avoid.
  double out = 0.5, largest = 0.0;
  for (std::size_t i = ahead_at_ + 1; i < ahead_.size(); ++i) {
    const double share = (ahead_[i].begin_m - u_m_) / length_m;
    if (share > 0.95) break;
    if (share < 0.05) continue;
    const auto size = [&](const Blend::Point& third) {
      return third.head<3>().norm() + third.segment<3>(3).norm() * axis_weight_m_;
    };
    const Blend::Point before = ahead_[i - 1].coefficients.col(3), after = ahead_[i].coefficients.col(3);
    if (const double step = size(after - before); step > largest) {
      largest = step;
      out = share + (size(before) > size(after) ? -0.005 : 0.005);
    }
  }
  return out;
}

Planner::Status Planner::look(SpeedSegment& segment, double length_m, bool& even) noexcept {
  segment.length_m = length_m;
  segment.share[1] = middle_share(length_m);
  std::array<robot::JointJet, point_count> joints;
  std::size_t at = ahead_at_;
  const robot::Position6 before = near_;
  for (std::size_t p = 0; p < point_count; ++p) {
    const double u_m = u_m_ + segment.share[p] * length_m;
    while (at + 1 < ahead_.size() && ahead_[at + 1].begin_m <= u_m) ++at;
    const Status status = look_at(ahead_[at], u_m - ahead_[at].begin_m, segment.point[p], joints[p]);
    if (!status.ok()) {
      near_ = before;
      return status;
    }
    near_ = joints[p].col(0);
  }
  // What joins the points must be what their slopes say, or something between them was missed.
  even = true;
  for (std::size_t p = 0; p + 1 < point_count; ++p) {
    const double apart_m = (segment.share[p + 1] - segment.share[p]) * length_m;
    for (Eigen::Index k = 0; k < 6; ++k) {
      const double met = joints[p + 1](k, 0) - joints[p](k, 0);
      const double reported = 0.5 * (joints[p](k, 1) + joints[p + 1](k, 1)) * apart_m;
      const double size = std::max(std::abs(joints[p](k, 1)), std::abs(joints[p + 1](k, 1))) * apart_m;
      if (std::abs(met - reported) > 0.2 * size + 1e-6) even = false;
    }
  }
  limit_speed(segment);
  return {};
}

void Planner::limit_speed(SpeedSegment& segment) const noexcept {
  // The slowest feed on the segment holds for all of it; the tip's rate is looked at where its polynomials join.
  double max_rate = 1e300, max_tip = 1e300;
  std::array<double, point_count> tip_rate_inverse = {};
  for (std::size_t p = 0; p < point_count; ++p)
    tip_rate_inverse[p] = 1.0 / std::max(std::abs(segment.point[p].c1[6]), 1e-12);
  const double end_m = u_m_ + segment.length_m;
  for (std::size_t i = ahead_at_; i < ahead_.size() && ahead_[i].begin_m < end_m; ++i) {
    const Polynomial& here = ahead_[i];
    max_rate = std::min(max_rate, here.max_rate_m_per_s);
    max_tip = std::min(max_tip, here.max_tip_m_per_s);
    for (const double share : {0.0, 0.5, 1.0}) {
      const double x_m = share * here.length_m, u_m = here.begin_m + x_m;
      if (u_m < u_m_ || u_m > end_m) continue;
      const Eigen::Vector3d rate = (((4.0 * here.coefficients.col(4) * x_m + 3.0 * here.coefficients.col(3)) * x_m +
                                     2.0 * here.coefficients.col(2)) *
                                        x_m +
                                    here.coefficients.col(1))
                                       .head<3>();
      const double place = (u_m - u_m_) / segment.length_m;
      double& inverse = tip_rate_inverse[place < 0.25 ? 0 : place < 0.75 ? 1 : 2];
      inverse = std::min(inverse, 1.0 / std::max(rate.norm(), 1e-12));
    }
  }
  const double speed = corrected_speed(u_m_, end_m);
  for (std::size_t p = 0; p < point_count; ++p) {
    PathPoint& point = segment.point[p];
    point.speed = speed;
    double most = planner_.share * std::min(max_rate, std::min(max_tip, limits_.velocity[6]) * tip_rate_inverse[p]);
    for (std::size_t k = 0; k < channel_count; ++k) {
      most = std::min(most, limits_.velocity[k] / std::max(std::abs(point.c1[k]), 1e-12));
    }
    most *= speed;
    point.max_b = most * most;
  }
}

Planner::Status Planner::lay(Segment::Kind kind, double length_m) noexcept {
  SpeedSegment segment;
  segment.kind = kind;
  const robot::Position6 before = near_;
  for (int tries = 0; tries < 12; ++tries) {
    bool even = true;
    near_ = before;
    const Status status = look(segment, length_m, even);
    if (!status.ok()) return status;
    if (even || kind != Segment::Kind::cruise) break;
    length_m *= 0.5;
  }
  segment.safe_b = solver_.own_safe_b(segment);
  row_.push_back(segment);
  begin_m_.push_back(u_m_);
  u_m_ += length_m;
  while (ahead_at_ + 1 < ahead_.size() && ahead_[ahead_at_ + 1].begin_m <= u_m_) ++ahead_at_;
  return {};
}

void Planner::come_to_rest(double at_m, double dwell_s) noexcept {
  solve(true);
  u_m_ = chain_begin_m_ = at_m;
  resting_ = true;
  if (proposed_) {
    waiting_s_ += dwell_s;
  } else if (dwell_s > 0.0) {
    motion_.push_back({.kind = Segment::Kind::dwell, .begin_m = at_m, .dwell_s = dwell_s});
  }
  ahead_.clear();
  ahead_at_ = 0;
}

Planner::Status Planner::lay_segments() noexcept {
  busy_ = false;
  bool pressed = blend_.room() < spare_nodes;
  while (!ahead_.empty()) {
    if (proposed_ || motion_.size() + 2 >= motion_.capacity() - planner_.window ||
        (task_ == Task::points && points_.size() + row_points() > points_.capacity())) {
      busy_ = true;
      break;
    }
    const Polynomial& last = ahead_.back();
    const double end_m = last.begin_m + last.length_m;
    const bool closed = last.stop;
    double length_m = std::min(spacing_m(u_m_), rest_m_ + growth * (u_m_ - chain_begin_m_));
    if (ahead_at_ + max_pieces < ahead_.size()) {
      length_m = std::min(length_m, ahead_[ahead_at_ + max_pieces].begin_m - u_m_);
    }
    if (const double most_m = (end_m - u_m_) / 3.0; !closed && length_m >= most_m) {
      // What follows may want short segments; they are laid only where the blocks are too short to hold enough of them.
      if (!pressed) break;
      length_m = most_m;
      pressed = false;
    }
    const double last_m =
        closed ? std::min({rest_m_, spacing_m(u_m_), 0.25 * (end_m - chain_begin_m_), 0.5 * (end_m - u_m_)}) : 0.0;
    const double dwell_s = last.dwell_s;
    Segment::Kind kind = Segment::Kind::cruise;
    bool ends = false;
    if (!resting_) length_m = snapped_m(length_m);
    if (resting_) {
      wait();
      kind = Segment::Kind::from_rest;
      length_m = closed ? std::min(length_m, 0.25 * (end_m - chain_begin_m_)) : length_m;
    } else if (closed) {
      const double left_m = end_m - last_m - u_m_;
      length_m = std::min(length_m, last_m + growth / (1.0 + growth) * std::max(0.0, left_m));
      ends = left_m < 1.5 * length_m;
      if (ends) length_m = left_m;
    }
    if (const Status status = lay(kind, length_m); !status.ok()) return status;
    resting_ = false;
    if (ends && u_m_ > end_m - 1.0001 * last_m) {
      u_m_ = end_m - last_m;
      if (const Status status = lay(Segment::Kind::to_rest, last_m); !status.ok()) return status;
      come_to_rest(end_m, dwell_s);
    } else if (row_.size() >= planner_.window) {
      solve(false);
    }
  }
  busy_ = busy_ || proposed_;
  if (ahead_at_ > 0) {
    ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(ahead_at_));
    ahead_at_ = 0;
  }
  static_cast<void>(spacing_m(u_m_));
  blend_.forget(std::min(near_node_, pieces_taken_));
  return {};
}

}  // namespace robomill::path
