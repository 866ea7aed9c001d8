// The speed along a row of segments: sought, revised where samples would break a limit, and written down as motion.
#include <algorithm>
#include <cmath>

#include "robomill/path/speed/planner.hpp"

namespace robomill::path {
namespace {

/// Of a limit: below it a segment's points are believed. By how much the tip's way may change in an even segment.
constexpr double tense_share = 0.5, even_share = 0.0005;
/// Segments beside a corrected one that are slowed down as much; how many ramps a local slow-down reaches.
constexpr std::size_t neighbours = 2;
constexpr double reach_in_ramps = 30.0;
/// … and beyond how many nothing of it is noticeable.
constexpr double noticeable_in_ramps = 8.0;

}  // namespace

double Planner::corrected_speed(double begin_m, double end_m) const noexcept {
  double out = 1.0;
  if (corrections_ == nullptr) return out;
  const auto cell = static_cast<std::int64_t>(std::floor(begin_m * SpeedCorrections::cells_per_m));
  for (auto correct = corrections_->speed.lower_bound(cell);
       correct != corrections_->speed.end() &&
       static_cast<double>(correct->first) <= end_m * SpeedCorrections::cells_per_m;
       ++correct) {
    out = std::min(out, correct->second);
  }
  return out;
}

bool Planner::slow_down(std::size_t segment, double speed) noexcept {
  const double factor = speed / row_[segment].point[0].speed;
  if (factor == 1.0) return false;
  for (PathPoint& point : row_[segment].point) {
    point.speed = speed;
    point.max_b *= factor * factor;
  }
  row_[segment].safe_b = solver_.own_safe_b(row_[segment]);
  return true;
}

void Planner::begin_safe_speed(std::size_t size) noexcept {
  for (; safe_to_ < size; ++safe_to_) {
    double b = row_[safe_to_].safe_b;
    if (safe_to_ > 0) b = std::min(b, row_[safe_to_ - 1].safe_b);
    if (safe_to_ + 1 < row_.size()) b = std::min(b, row_[safe_to_ + 1].safe_b);
    row_[safe_to_].b = 0.9 * b;
  }
}

void Planner::hand_over(bool to_rest) noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    const SpeedSegment& segment = row_[i];
    if (segment.kind == Segment::Kind::from_rest) points_.push_back({.u_m = begin_m_[i], .max_b = 0.0, .rests = true});
    for (std::size_t p = 0; p < point_count; ++p) {
      const PathPoint& point = segment.point[p];
      const double u_m = begin_m_[i] + segment.share[p] * segment.length_m;
      points_.push_back({.u_m = u_m, .c1 = point.c1, .c2 = point.c2, .max_b = point.max_b});
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
  // Without a stop the last segment waits: its safe terminal speed depends on the next one.
  solved_ = to_rest ? row_.size() : row_.size() - 1;
  moved_ = to_rest ? solved_ : solved_ - 2;
  taken_ = to_rest ? solved_ : std::min(planner_.commit, solved_ - 4);
  safe_before_ = safe_to_;
  begin_safe_speed(solved_);
  before_.clear();
  for (const SpeedSegment& segment : row_) before_.push_back({.begin_b = segment.b});
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

bool Planner::tense(std::size_t segment) const noexcept {
  const SpeedSegment& here = row_[segment];
  if (here.kind != Segment::Kind::cruise) return true;
  const SegmentEnds ends = ends_of(row_.data(), solved_, segment);
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
    // Differences begin in the segment before.
    for (std::size_t k = i > 0 ? i - 1 : 0; k <= std::min(i + 1, solved_ - 1); ++k) before_[k].suspect = true;
  }
}

void Planner::slow_down_around_corrections(double ramp_m) noexcept {
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
    const std::size_t low = k > neighbours ? k - neighbours : 0, high = std::min(k + neighbours, solved_ - 1);
    const double from_m = begin_m_[low], to_m = begin_m_[high] + row_[high].length_m;
    const auto lower = [&](std::size_t i, double away_m) {
      if (i < frozen_ || i >= moved_ || away_m > reach_in_ramps * ramp_m) return false;
      row_[i].b = std::min(row_[i].b, before_[i].found_b * (1.0 - depth * std::exp(-away_m / ramp_m)));
      before_[i].suspect = before_[i].suspect || away_m < noticeable_in_ramps * ramp_m;
      return true;
    };
    for (std::size_t i = low; i <= high; ++i) lower(i, 0.0);
    for (std::size_t i = low; i-- > 0 && lower(i, std::max(0.0, from_m - middle_m(i)));) {
    }
    for (std::size_t i = high + 1; i < solved_ && lower(i, std::max(0.0, middle_m(i) - to_m)); ++i) {
    }
  }
}

bool Planner::slow_down_locally() noexcept {
  SpeedOptions look = planner_.speed;
  look.max_iterations = 0;
  for (const double ramp_m : {1.0 * largest_segment_m_, 3.0 * largest_segment_m_, 9.0 * largest_segment_m_}) {
    slow_down_around_corrections(ramp_m);
    if (solver_.solve(row_.data(), solved_, frozen_, moved_, look).feasible) return true;
  }
  return false;
}

bool Planner::revise() noexcept {
  for (std::size_t i = 0; i < row_.size(); ++i) {
    before_[i].found_b = row_[i].b;
    before_[i].speed = row_[i].point[0].speed;
  }
  // What the row before left over moves already, maybe too fast for a correction: then the fresh segments alone.
  for (const std::size_t from : {frozen_, std::max(frozen_, safe_before_)}) {
    bool slower = false;
    for (std::size_t i = from; i < row_.size(); ++i) {
      slower = slow_down(i, corrected_speed(begin_m_[i], begin_m_[i] + row_[i].length_m)) || slower;
    }
    if (slower && planner_.local_slow_down && slow_down_locally()) {
      motion_.erase(motion_.begin() + static_cast<std::ptrdiff_t>(proposed_at_), motion_.end());
      write(moved_ == solved_ ? solved_ : solved_ - 1);
      return true;
    }
    for (std::size_t i = 0; i < safe_before_; ++i) row_[i].b = before_[i].begin_b;
    safe_to_ = safe_before_;
    begin_safe_speed(solved_);
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
    Segment segment{.kind = row_[i].kind, .begin_m = begin_m_[i], .length_m = row_[i].length_m};
    if (segment.kind == Segment::Kind::cruise) {
      const SegmentEnds ends = ends_of(row_.data(), solved_, i);
      segment.begin_b = ends.begin_b;
      segment.middle_b = row_[i].b;
      segment.end_b = ends.end_b;
    } else if (segment.kind == Segment::Kind::from_rest) {
      segment.end_b = ends_of(row_.data(), solved_, i + 1).begin_b;
    } else {
      segment.begin_b = ends_of(row_.data(), solved_, i - 1).end_b;
    }
    motion_.push_back(segment);
  }
}

void Planner::take_over() noexcept {
  const std::size_t gone = taken_ == row_.size() ? taken_ : taken_ - 1;
  row_.erase(row_.begin(), row_.begin() + static_cast<std::ptrdiff_t>(gone));
  begin_m_.erase(begin_m_.begin(), begin_m_.begin() + static_cast<std::ptrdiff_t>(gone));
  safe_to_ -= gone;
  frozen_ = row_.empty() ? 0 : 2;
}

}  // namespace robomill::path
