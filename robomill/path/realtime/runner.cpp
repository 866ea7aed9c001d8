#include "robomill/path/realtime/runner.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::path {
namespace {

/// How long before it must the override begins to sink towards a cap, in periods: it arrives at rest.
constexpr double early_periods = 12.0;
/// Looks at ever smaller slopes before a step is given up.
constexpr int max_looks = 12;
constexpr double rounding = 1e-9;

}  // namespace

Runner::Runner(LookAhead& ahead, const robot::Kinematics& kinematics, double period_s, const Sample& start)
    : ahead_(ahead), kinematics_(kinematics), period_s_(period_s), last_(start) {}

double Runner::ready_s() const noexcept {
  const std::size_t end = ahead_.stretches.end();
  return end > stretch_ ? ahead_.stretches[end - 1].end_s - now_s_ : 0.0;
}

bool Runner::extend(View& view) noexcept {
  if (view.rests || view.next >= known_) return false;
  const Stretch& stretch = ahead_.stretches[view.next];
  if (view.next == stretch_ || stretch.slope < view.slope) view.slope = stretch.slope;
  const double lowest = view.steps > 0 ? step_[view.steps - 1].feed_override : override_limits::max;
  const double cap = wanted_ > 1.0 ? stretch.cap : stretch.feed;
  if (cap < lowest && view.steps < max_steps) {
    step_[view.steps++] = {
        .theta = theta_of(cap), .feed_override = cap, .begin_s = std::max(0.0, view.covered_s), .end_s = stretch.end_s};
  }
  view.covered_s = stretch.end_s - now_s_;
  view.rests = stretch.kind == Stretch::Kind::rests;
  ++view.next;
  return true;
}

bool Runner::meets(const View& view, const OverrideState& to, double passed_s) const noexcept {
  const double peak = override_of(to.peak(view.slope));
  for (std::size_t i = 0; i < view.steps; ++i) {
    const Step& step = step_[i];
    if (peak <= step.feed_override * (1.0 + rounding)) continue;
    if (passed_s + travel_s(to, 0.0, step.theta, view.slope, period_s_) > step.begin_s) return false;
  }
  return true;
}

double Runner::lowered(const View& view, const OverrideState& to, double passed_s, double target) noexcept {
  const double early_s = early_periods * period_s_ * std::max(override_of(to.theta), 0.05);
  for (std::size_t i = 0; i < view.steps; ++i) {
    const Step& step = step_[i];
    if (step.theta >= target) continue;
    const double settles_s = travel_s(to, step.theta, step.theta, view.slope, period_s_);
    const bool above = to.peak(view.slope) > step.theta * (1.0 + rounding);
    if (above && passed_s + settles_s + early_s > step.begin_s) {
      target = step.theta;
      if (low_until_s_ <= now_s_ || target <= low_theta_) {
        low_theta_ = target;
        low_until_s_ = step.end_s;
      }
    }
  }
  return target;
}

Runner::Verdict Runner::consider(double target, const OverrideState* fixed, OverrideState& to, double& slope) noexcept {
  View view{.next = stretch_};
  if (!extend(view)) return Verdict::too_short;
  for (int looks = 0; looks < max_looks; ++looks) {
    slope = view.slope;
    to = fixed != nullptr ? *fixed : approach(state_, target, slope, period_s_);
    const double passed_s =
        fixed != nullptr ? period_s_ * override_of(to.theta) : path::passed_s(state_, to, period_s_);
    const double needed_s = passed_s + travel_s(to, 0.0, 0.0, slope, period_s_);
    if (!std::isfinite(needed_s)) return Verdict::too_fast;
    if (to.speed > 0.0 && fixed == nullptr && to.peak(slope) > theta_of(wanted_) + rounding) return Verdict::too_fast;
    while (view.covered_s < needed_s && extend(view)) {
    }
    if (view.slope < slope) continue;
    if (view.covered_s < needed_s && !view.rests) return Verdict::too_short;
    if (fixed == nullptr) {
      const double lower = lowered(view, to, passed_s, target);
      if (lower < target) {
        target = lower;
        continue;
      }
    }
    return meets(view, to, passed_s) ? Verdict::holds : Verdict::too_fast;
  }
  return Verdict::too_fast;
}

bool Runner::rest(double wanted) noexcept {
  // Dwells run by the clock, whatever the override.
  if (stretch_ >= known_) return false;
  const Stretch& stretch = ahead_.stretches[stretch_];
  if (stretch.kind == Stretch::Kind::dwell) {
    pass(period_s_);
    return false;
  }
  if (!(wanted > 0.0)) return false;
  wanted_ = wanted;
  for (const double share : {1.0, 0.8, 0.6, 0.4, 0.2, 0.0}) {
    const OverrideState from{.theta = theta_of(wanted * share)};
    OverrideState to;
    double slope = stretch.slope;
    if (consider(0.0, &from, to, slope) == Verdict::holds || share == 0.0) {
      state_ = from;
      way_out_ = slope;
      resting_ = starved_ = false;
      low_until_s_ = -1.0;
      pass(period_s_ * override_of(state_.theta));
      break;
    }
  }
  return true;
}

void Runner::run(double wanted) noexcept {
  wanted_ = wanted;
  double target = starved_ ? 0.0 : theta_of(wanted);
  if (low_until_s_ > now_s_) target = std::min(target, low_theta_);
  OverrideState to;
  double slope = way_out_;
  const Verdict verdict = consider(target, nullptr, to, slope);
  if (verdict == Verdict::holds) {
    way_out_ = slope;
  } else {
    starved_ = starved_ || verdict == Verdict::too_short;
    to = approach(state_, 0.0, way_out_, period_s_);
  }
  to.theta = std::max(to.theta, 0.0);
  const double plan_s = passed_s(state_, to, period_s_);
  state_ = to;
  pass(plan_s);
}

void Runner::pass(double plan_s) noexcept {
  now_s_ += plan_s;
  while (stretch_ < known_ && ahead_.stretches[stretch_].end_s <= now_s_) {
    const Stretch& passed = ahead_.stretches[stretch_++];
    if (passed.kind != Stretch::Kind::flows) {
      now_s_ = passed.end_s;
      state_ = {};
      resting_ = true;
      break;
    }
    if (stretch_ == known_) now_s_ = passed.end_s;
  }
  ahead_.stretches.drop_before(stretch_);
}

void Runner::emit(Sample& sample) noexcept {
  last_.time_s = static_cast<double>(count_++) * period_s_;
  if (now_s_ != moved_s_ && known_ > 0) {
    moved_s_ = now_s_;
    const std::size_t segments = ahead_.motion.end();
    while (segment_ + 1 < segments && ahead_.motion[segment_ + 1].begin_s <= now_s_) ++segment_;
    ahead_.motion.drop_before(segment_);
    const TimedSegment& timed = ahead_.motion[segment_];
    const double t_s = std::clamp(now_s_ - timed.begin_s, 0.0, timed.length_s);
    const double u_m = timed.segment.begin_m + way_m(timed.segment, t_s, timed.length_s);
    const std::size_t pieces = ahead_.path.end();
    while (piece_ + 1 < pieces && ahead_.path[piece_ + 1].begin_m <= u_m) ++piece_;
    ahead_.path.drop_before(piece_);
    const Polynomial& piece = ahead_.path[piece_];
    const robot::ToolPose pose = piece.pose(u_m - piece.begin_m);
    robot::Position6 joints;
    // The survey has been here: it can be reached.
    if (kinematics_.follow(pose, last_.joints, joints).status == robot::Reach::Status::found) {
      last_.joints = joints;
      last_.tip_m = pose.tip_m;
      last_.axis = pose.axis;
      last_.block = piece.block;
      last_.path_m = u_m;
    }
  }
  sample = last_;
}

Runner::State Runner::state(double wanted, LookAhead::Closed closed) const noexcept {
  const bool still = resting_ || (state_.theta == 0.0 && state_.speed == 0.0);
  if (!still) return State::running;
  if (stretch_ >= known_ && closed == LookAhead::Closed::whole && resting_) return State::finished;
  if ((stretch_ >= known_ || starved_) && closed == LookAhead::Closed::broken) return State::stopped;
  if (!(wanted > 0.0)) return State::holding;
  return stretch_ >= known_ || starved_ ? State::waiting : State::running;
}

Runner::State Runner::next(double wanted, Sample& sample) noexcept {
  const LookAhead::Closed closed = ahead_.closed.load(std::memory_order_acquire);
  if (const std::size_t known = ahead_.stretches.end(); known != known_) {
    known_ = known;
    starved_ = false;
  }
  if (count_ > 0) {
    if (resting_) {
      rest(wanted);
    } else {
      run(wanted);
    }
  }
  emit(sample);
  lacks_ = closed == LookAhead::Closed::no && wanted > 0.0 && (starved_ || stretch_ >= known_);
  return state(wanted, closed);
}

}  // namespace robomill::path
