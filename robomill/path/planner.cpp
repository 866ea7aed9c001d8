#include "robomill/path/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace robomill::path {
namespace {

/// How fast spans may grow away from a corner.
constexpr double growth = 0.5;
/// Of a limit: below it a span's points are believed. By how much the tip's way may change in a span that is even.
constexpr double tense_share = 0.5, even_share = 0.0005;
/// Spans beside a mended one that are slowed down as much; how many ramps a dip reaches.
constexpr std::size_t dip_beside = 2;
constexpr double dip_reach = 30.0;
/// … and beyond how many nothing of it can be told.
constexpr double dip_felt = 8.0;
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
          .dip = false};
}

PlannerOptions PlannerOptions::real_time() {
  return {.window = 240, .commit = 60, .look_ahead = 128};
}

/// A row's, and where the tool rests.
std::size_t Planner::row_points() const noexcept {
  return point_count * (planner_.window + 8) + 2;
}

Planner::Planner(const robot::Kinematics& kinematics, const SmoothingOptions& options, const PlannerOptions& planner,
                 const Mends* mends, Task task)
    : kinematics_(kinematics),
      planner_(planner),
      mends_(mends),
      task_(task),
      limits_((options.validate(), kinematics.limits().validate(kinematics.joints()),
               channel_limits(kinematics, options, planner))),
      blend_(options, planner.look_ahead + spare_nodes),
      solver_(limits_, planner.window + 8) {
  const double v = options.max_velocity_m_per_s, a = options.max_acceleration_m_per_s2, j = options.max_jerk_m_per_s3;
  // Not below what passes in a few samples, however stiff the limits.
  largest_span_m_ = std::max(0.3 * planner.spacing * v * v / a, 3.0 * v * options.sample_period_s);
  axis_weight_m_ = j / options.max_angular_jerk_rad_per_s3;
  rest_m_ = std::clamp(0.25 * a * a * a / (6.0 * j * j), 1e-3 * largest_span_m_, largest_span_m_);
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
  ahead_at_ = pieces_taken_ = near_node_ = frozen_ = crept_ = 0;
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
  if (mends_ != nullptr) {
    const auto mend = mends_->tolerance.find(index);
    if (mend != mends_->tolerance.end()) tolerance = mend->second;
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
  if (waiting_s_ > 0.0) motion_.push_back({.kind = Span::Kind::dwell, .begin_m = u_m_, .dwell_s = waiting_s_});
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
  return lay_spans();
}

Planner::Status Planner::advance() noexcept {
  blend_.settle();
  take_polynomials();
  return lay_spans();
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
  double out = largest_span_m_;
  const auto meet = [&](const Blend::Node& corner) {
    if (corner.stop || corner.step.squaredNorm() < 1e-16) return;
    const double gap = std::max(0.0, std::abs(u_m - corner.u_m) - corner.half_width_m);
    // Towards a corner the span itself shortens the gap.
    const double rate = u_m < corner.u_m ? growth / (1.0 + growth) : growth;
    out = std::min(out, planner_.spacing * corner.half_width_m + rate * gap);
  };
  const double reach_m = blend_.max_half_width_m() + largest_span_m_ / growth;
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
  // Third derivatives step where polynomials join: where they do so in earnest a span should end.
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
  // The middle, or the steeper side of the largest step of third derivatives that the span could not avoid.
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

Planner::Status Planner::look(SpeedSpan& span, double length_m, bool& even) noexcept {
  span.length_m = length_m;
  span.share[1] = middle_share(length_m);
  std::array<robot::JointJet, point_count> joints;
  std::size_t at = ahead_at_;
  const robot::Position6 before = near_;
  for (std::size_t p = 0; p < point_count; ++p) {
    const double u_m = u_m_ + span.share[p] * length_m;
    while (at + 1 < ahead_.size() && ahead_[at + 1].begin_m <= u_m) ++at;
    const Status status = look_at(ahead_[at], u_m - ahead_[at].begin_m, span.point[p], joints[p]);
    if (!status.ok()) {
      near_ = before;
      return status;
    }
    near_ = joints[p].col(0);
  }
  // What joins the points must be what their slopes say, or something between them was missed.
  even = true;
  for (std::size_t p = 0; p + 1 < point_count; ++p) {
    const double apart_m = (span.share[p + 1] - span.share[p]) * length_m;
    for (Eigen::Index k = 0; k < 6; ++k) {
      const double met = joints[p + 1](k, 0) - joints[p](k, 0);
      const double told = 0.5 * (joints[p](k, 1) + joints[p + 1](k, 1)) * apart_m;
      const double size = std::max(std::abs(joints[p](k, 1)), std::abs(joints[p + 1](k, 1))) * apart_m;
      if (std::abs(met - told) > 0.2 * size + 1e-6) even = false;
    }
  }
  limit_speed(span);
  return {};
}

void Planner::limit_speed(SpeedSpan& span) const noexcept {
  // The slowest feed that the span meets holds for all of it; the tip's rate is looked at where its polynomials join.
  double max_rate = 1e300, max_tip = 1e300;
  std::array<double, point_count> tip_rate_inverse = {};
  for (std::size_t p = 0; p < point_count; ++p)
    tip_rate_inverse[p] = 1.0 / std::max(std::abs(span.point[p].c1[6]), 1e-12);
  const double end_m = u_m_ + span.length_m;
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
      const double place = (u_m - u_m_) / span.length_m;
      double& inverse = tip_rate_inverse[place < 0.25 ? 0 : place < 0.75 ? 1 : 2];
      inverse = std::min(inverse, 1.0 / std::max(rate.norm(), 1e-12));
    }
  }
  const double speed = mended_speed(u_m_, end_m);
  for (std::size_t p = 0; p < point_count; ++p) {
    PathPoint& point = span.point[p];
    point.speed = speed;
    double most = planner_.share * std::min(max_rate, std::min(max_tip, limits_.velocity[6]) * tip_rate_inverse[p]);
    for (std::size_t k = 0; k < channel_count; ++k) {
      most = std::min(most, limits_.velocity[k] / std::max(std::abs(point.c1[k]), 1e-12));
    }
    most *= speed;
    point.max_b = most * most;
  }
}

double Planner::mended_speed(double begin_m, double end_m) const noexcept {
  double out = 1.0;
  if (mends_ == nullptr) return out;
  const auto cell = static_cast<std::int64_t>(std::floor(begin_m * Mends::cells_per_m));
  for (auto mend = mends_->speed.lower_bound(cell);
       mend != mends_->speed.end() && static_cast<double>(mend->first) <= end_m * Mends::cells_per_m; ++mend) {
    out = std::min(out, mend->second);
  }
  return out;
}

bool Planner::slow_down(std::size_t span, double speed) noexcept {
  const double factor = speed / row_[span].point[0].speed;
  if (factor == 1.0) return false;
  for (PathPoint& point : row_[span].point) {
    point.speed = speed;
    point.max_b *= factor * factor;
  }
  row_[span].creep_b = solver_.own_creep_b(row_[span]);
  return true;
}

Planner::Status Planner::lay(Span::Kind kind, double length_m) noexcept {
  SpeedSpan span;
  span.kind = kind;
  const robot::Position6 before = near_;
  for (int tries = 0; tries < 12; ++tries) {
    bool even = true;
    near_ = before;
    const Status status = look(span, length_m, even);
    if (!status.ok()) return status;
    if (even || kind != Span::Kind::cruise) break;
    length_m *= 0.5;
  }
  span.creep_b = solver_.own_creep_b(span);
  row_.push_back(span);
  begin_m_.push_back(u_m_);
  u_m_ += length_m;
  while (ahead_at_ + 1 < ahead_.size() && ahead_[ahead_at_ + 1].begin_m <= u_m_) ++ahead_at_;
  return {};
}

Planner::Status Planner::lay_spans() noexcept {
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
      // What follows may want short spans; they are laid only where the blocks are too short to hold enough of them.
      if (!pressed) break;
      length_m = most_m;
      pressed = false;
    }
    const double last_m =
        closed ? std::min({rest_m_, spacing_m(u_m_), 0.25 * (end_m - chain_begin_m_), 0.5 * (end_m - u_m_)}) : 0.0;
    const double dwell_s = last.dwell_s;
    Span::Kind kind = Span::Kind::cruise;
    bool ends = false;
    if (!resting_) length_m = snapped_m(length_m);
    if (resting_) {
      wait();
      kind = Span::Kind::from_rest;
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
      if (const Status status = lay(Span::Kind::to_rest, last_m); !status.ok()) return status;
      solve(true);
      u_m_ = chain_begin_m_ = end_m;
      resting_ = true;
      if (proposed_) {
        waiting_s_ += dwell_s;
      } else if (dwell_s > 0.0) {
        motion_.push_back({.kind = Span::Kind::dwell, .begin_m = end_m, .dwell_s = dwell_s});
      }
      ahead_.clear();
      ahead_at_ = 0;
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

void Planner::begin_creeping(std::size_t size) noexcept {
  for (; crept_ < size; ++crept_) {
    double b = row_[crept_].creep_b;
    if (crept_ > 0) b = std::min(b, row_[crept_ - 1].creep_b);
    if (crept_ + 1 < row_.size()) b = std::min(b, row_[crept_ + 1].creep_b);
    row_[crept_].b = 0.9 * b;
  }
}

void Planner::hand_over(bool to_rest) noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    const SpeedSpan& span = row_[i];
    if (span.kind == Span::Kind::from_rest) points_.push_back({.u_m = begin_m_[i], .max_b = 0.0, .rests = true});
    for (std::size_t p = 0; p < point_count; ++p) {
      const PathPoint& point = span.point[p];
      points_.push_back(
          {.u_m = begin_m_[i] + span.share[p] * span.length_m, .c1 = point.c1, .c2 = point.c2, .max_b = point.max_b});
    }
  }
  if (to_rest) points_.push_back({.u_m = begin_m_.back() + row_.back().length_m, .max_b = 0.0, .rests = true});
  row_.clear();
  begin_m_.clear();
}

void Planner::solve(bool to_rest) noexcept {
  if (task_ == Task::points) {
    hand_over(to_rest);
    return;
  }
  // Without a stop the last span waits: its creep needs to know of the next.
  solved_ = to_rest ? row_.size() : row_.size() - 1;
  moved_ = to_rest ? solved_ : solved_ - 2;
  taken_ = to_rest ? solved_ : std::min(planner_.commit, solved_ - 4);
  crept_before_ = crept_;
  begin_creeping(solved_);
  before_.clear();
  for (const SpeedSpan& span : row_) before_.push_back({.begin_b = span.b});
  solve_row();
  if (task_ == Task::motion) {
    write(taken_);
    take_over();
    return;
  }
  find_suspects();
  proposed_ = true;
  proposed_at_ = motion_.size();
  kept_ = proposed_at_ + taken_ - (frozen_ > 0 ? 1 : 0);
  write(to_rest ? solved_ : solved_ - 1);
}

bool Planner::solve_row() noexcept {
  return solver_.solve(row_.data(), solved_, frozen_, moved_, planner_.speed).feasible;
}

bool Planner::tense(std::size_t span) const noexcept {
  const SpeedSpan& here = row_[span];
  if (here.kind != Span::Kind::cruise) return true;
  const SpanEnds ends = ends_of(row_.data(), solved_, span);
  double slowest = 1e300, fastest = 0.0;
  bool at_feed = false;
  for (std::size_t p = 0; p < point_count; ++p) {
    const PathPoint& point = here.point[p];
    const double t = here.share[p], s = 1.0 - t, d = here.length_m;
    const double b = s * s * ends.begin_b + 2.0 * s * t * here.b + t * t * ends.end_b;
    const double first = 2.0 / d * (s * (here.b - ends.begin_b) + t * (ends.end_b - here.b));
    const double second = 2.0 / (d * d) * (ends.begin_b - 2.0 * here.b + ends.end_b), rate = std::sqrt(b);
    bool near = false;
    for (std::size_t k = 0; k < channel_count; ++k) {
      const double a = point.c2[k] * b + 0.5 * point.c1[k] * first;
      const double j = rate * (point.c3[k] * b + 1.5 * point.c2[k] * first + 0.5 * point.c1[k] * second);
      near = near || std::abs(a) > tense_share * limits_.acceleration[k] || std::abs(j) > tense_share * limits_.jerk[k];
    }
    if (near) return true;
    at_feed = at_feed || b > tense_share * point.max_b;
    slowest = std::min(slowest, std::abs(point.c1[6]));
    fastest = std::max(fastest, std::abs(point.c1[6]));
  }
  // At the feed only where the tip's way along the path is uneven.
  return at_feed && fastest - slowest > even_share * fastest;
}

void Planner::find_suspects() noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) before_[i].suspect = false;
  for (std::size_t i = 0; i < solved_; ++i) {
    if (!tense(i)) continue;
    // Differences begin in the span before.
    for (std::size_t k = i > 0 ? i - 1 : 0; k <= std::min(i + 1, solved_ - 1); ++k) before_[k].suspect = true;
  }
}

void Planner::dip_row(double ramp_m) noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    row_[i].b = before_[i].found_b;
    before_[i].suspect = false;
  }
  const auto middle_m = [&](std::size_t i) { return begin_m_[i] + 0.5 * row_[i].length_m; };
  for (std::size_t k = 0; k < solved_; ++k) {
    const double factor = row_[k].point[0].speed / before_[k].speed;
    if (factor == 1.0) continue;
    // A depth that dies away as exp(−d / ramp) asks for less of an acceleration than it sets free, however small.
    const double depth = 1.0 - factor * factor;
    const std::size_t low = k > dip_beside ? k - dip_beside : 0, high = std::min(k + dip_beside, solved_ - 1);
    const double from_m = begin_m_[low], to_m = begin_m_[high] + row_[high].length_m;
    const auto lower = [&](std::size_t i, double away_m) {
      if (i < frozen_ || i >= moved_ || away_m > dip_reach * ramp_m) return false;
      row_[i].b = std::min(row_[i].b, before_[i].found_b * (1.0 - depth * std::exp(-away_m / ramp_m)));
      before_[i].suspect = before_[i].suspect || away_m < dip_felt * ramp_m;
      return true;
    };
    for (std::size_t i = low; i <= high; ++i) lower(i, 0.0);
    for (std::size_t i = low; i-- > 0 && lower(i, std::max(0.0, from_m - middle_m(i)));) {
    }
    for (std::size_t i = high + 1; i < solved_ && lower(i, std::max(0.0, middle_m(i) - to_m)); ++i) {
    }
  }
}

bool Planner::dip() noexcept {
  SpeedOptions look = planner_.speed;
  look.max_iterations = 0;
  for (const double ramp_m : {1.0 * largest_span_m_, 3.0 * largest_span_m_, 9.0 * largest_span_m_}) {
    dip_row(ramp_m);
    if (solver_.solve(row_.data(), solved_, frozen_, moved_, look).feasible) return true;
  }
  return false;
}

bool Planner::revise() noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    before_[i].found_b = row_[i].b;
    before_[i].speed = row_[i].point[0].speed;
  }
  // What the row before left over moves already, and may do so too fast for a mend: then the fresh spans alone.
  for (const std::size_t from : {frozen_, std::max(frozen_, crept_before_)}) {
    bool slower = false;
    for (std::size_t i = from; i < row_.size(); ++i) {
      slower = slow_down(i, mended_speed(begin_m_[i], begin_m_[i] + row_[i].length_m)) || slower;
    }
    if (slower && planner_.dip && dip()) {
      motion_.erase(motion_.begin() + static_cast<std::ptrdiff_t>(proposed_at_), motion_.end());
      write(moved_ == solved_ ? solved_ : solved_ - 1);
      return true;
    }
    for (std::size_t i = 0; i < crept_before_; ++i) row_[i].b = before_[i].begin_b;
    crept_ = crept_before_;
    begin_creeping(solved_);
    if (slower && solve_row()) {
      find_suspects();
      motion_.erase(motion_.begin() + static_cast<std::ptrdiff_t>(proposed_at_), motion_.end());
      write(moved_ == solved_ ? solved_ : solved_ - 1);
      return true;
    }
    for (std::size_t i = from; i < row_.size(); ++i) slow_down(i, before_[i].speed);
  }
  for (std::size_t i = 0; i < row_.size(); ++i) row_[i].b = before_[i].found_b;
  return false;
}

void Planner::write(std::size_t count) noexcept {
  for (std::size_t i = frozen_ > 0 ? 1 : 0; i < count; ++i) {
    Span span{.kind = row_[i].kind, .begin_m = begin_m_[i], .length_m = row_[i].length_m};
    if (span.kind == Span::Kind::cruise) {
      const SpanEnds ends = ends_of(row_.data(), solved_, i);
      span.begin_b = ends.begin_b;
      span.middle_b = row_[i].b;
      span.end_b = ends.end_b;
    } else if (span.kind == Span::Kind::from_rest) {
      span.end_b = ends_of(row_.data(), solved_, i + 1).begin_b;
    } else {
      span.begin_b = ends_of(row_.data(), solved_, i - 1).end_b;
    }
    motion_.push_back(span);
  }
}

void Planner::take_over() noexcept {
  const std::size_t gone = taken_ == row_.size() ? taken_ : taken_ - 1;
  row_.erase(row_.begin(), row_.begin() + static_cast<std::ptrdiff_t>(gone));
  begin_m_.erase(begin_m_.begin(), begin_m_.begin() + static_cast<std::ptrdiff_t>(gone));
  crept_ -= gone;
  frozen_ = row_.empty() ? 0 : 2;
}

}  // namespace robomill::path
