#include "robomill/path/interpolator.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/path/realtime/runner.hpp"
#include "robomill/path/realtime/survey.hpp"
#include "robomill/path/speed/planner.hpp"

namespace robomill::path {
namespace {

using Pushed = PathInterpolator::Pushed;

bool sound(const program::Block& block) {
  if (!(block.duration_s >= 0.0) || !std::isfinite(block.duration_s)) return false;
  if (block.kind == program::Block::Kind::dwell) return true;
  if (!(block.tip_deviation_m >= 0.0 && block.axis_deviation_rad >= 0.0)) return false;
  return block.end.tip_m.allFinite() && block.end.axis.allFinite() &&
         std::abs(block.end.axis.squaredNorm() - 1.0) < 1e-9;
}

}  // namespace

void InterpolatorOptions::validate() const {
  require_positive("look_ahead_s", look_ahead_s, "s", "4 s suits most machines");
  if (look_ahead_segments < 64) {
    throw InvalidInput("look_ahead_segments", static_cast<double>(look_ahead_segments), "", "must be at least 64");
  }
}

struct PathInterpolator::Parts {
  Parts(const robot::Kinematics& kinematics, const SmoothingOptions& smoothing, const program::Pose& start,
        double gamma, const robot::Position6& joints, const InterpolatorOptions& options)
      : planner(kinematics, smoothing, PlannerOptions::interpolated()),
        // The path is put out before the segments on it are planned: as far ahead as a window reaches.
        ahead(Planner::max_pieces * PlannerOptions::interpolated().window + 2 * planner.path_capacity(),
              options.look_ahead_segments,
              static_cast<std::size_t>(options.look_ahead_s / (4.0 * smoothing.sample_period_s)) + 64),
        survey(ahead, kinematics, smoothing, joints),
        runner(ahead, kinematics, smoothing.sample_period_s,
               {.joints = joints, .tip_m = start.tip_m, .axis = start.axis}),
        gamma_rad(gamma) {}

  bool drain() noexcept;
  bool lay() noexcept;
  void fail(const Pushed& why) noexcept;
  void take(const Planner::Status& status) noexcept;

  Planner planner;
  LookAhead ahead;
  Survey survey;
  Runner runner;
  // Of the pushing thread.
  double gamma_rad;
  std::size_t blocks = 0, path_at = 0, motion_at = 0;
  bool finishing = false, failed = false;
  Pushed failure = {};
  // Of the thread that calls next().
  bool at_rest_for_good = false;
  // Of all.
  alignas(64) std::atomic<bool> held{false}, ended{false};
  std::atomic<double> override_share{1.0}, override_now{0.0};
};

void PathInterpolator::Parts::fail(const Pushed& why) noexcept {
  failed = true;
  failure = why;
  ahead.closed.store(LookAhead::Closed::broken, std::memory_order_release);
}

void PathInterpolator::Parts::take(const Planner::Status& status) noexcept {
  using Kind = Planner::Status::Kind;
  if (status.ok()) return;
  fail({.status = status.kind == Kind::antipodal ? Pushed::Status::antipodal : Pushed::Status::unreachable,
        .block = status.block,
        .line = status.line,
        .reach = status.reach});
}

/// What the planner has put out into the look-ahead; false where that is full.
bool PathInterpolator::Parts::lay() noexcept {
  std::vector<Polynomial>& path = planner.path();
  std::vector<Segment>& motion = planner.motion();
  for (; path_at < path.size(); ++path_at) {
    if (ahead.path.room() == 0) break;
    ahead.path.put(path[path_at]);
  }
  ahead.path.publish();
  if (path_at < path.size()) return false;
  for (; motion_at < motion.size(); ++motion_at) {
    const Survey::ScanStatus status = survey.take(motion[motion_at]);
    if (status == Survey::ScanStatus::full) return false;
    if (status == Survey::ScanStatus::unreachable) {
      fail({.status = Pushed::Status::unreachable,
            .block = survey.at().block,
            .line = survey.at().line,
            .reach = survey.reach()});
      return false;
    }
  }
  path.clear();
  motion.clear();
  path_at = motion_at = 0;
  return true;
}

/// … and what it still holds ready to be planned.
bool PathInterpolator::Parts::drain() noexcept {
  while (!failed && lay()) {
    if (!planner.busy()) return true;
    take(planner.resume());
  }
  return false;
}

PathInterpolator::PathInterpolator(const robot::Kinematics& kinematics, const SmoothingOptions& smoothing,
                                   const program::Pose& start, double gamma_rad, const robot::Position6& joints,
                                   const InterpolatorOptions& options) {
  options.validate();
  parts_ = std::make_unique<Parts>(kinematics, smoothing, start, gamma_rad, joints, options);
  const Planner::Status status = parts_->planner.begin(start, gamma_rad, joints);
  if (!status.ok()) throw InvalidInput("start", "cannot be taken by the machine", "Move the workpiece");
}

PathInterpolator::~PathInterpolator() = default;

Pushed PathInterpolator::push(const program::Block& block) noexcept {
  return push(block, parts_->gamma_rad);
}

Pushed PathInterpolator::push(const program::Block& block, double gamma_rad) noexcept {
  Parts& s = *parts_;
  const std::size_t index = s.blocks;
  if (s.failed) return s.failure;
  if (s.finishing || s.ended.load(std::memory_order_relaxed))
    return {.status = Pushed::Status::closed, .block = index, .line = block.line};
  if (!sound(block) || !std::isfinite(gamma_rad)) {
    return {.status = Pushed::Status::invalid, .block = index, .line = block.line};
  }
  const Pushed full{.status = Pushed::Status::full, .block = index, .line = block.line};
  if (!s.drain()) return s.failed ? s.failure : full;
  const Planner::Status status = s.planner.push(block, index, gamma_rad);
  if (status.kind == Planner::Status::Kind::full) return full;
  s.take(status);
  if (s.failed) return s.failure;
  ++s.blocks;
  s.gamma_rad = gamma_rad;
  static_cast<void>(s.drain());
  return s.failed ? s.failure : Pushed{.block = index, .line = block.line};
}

Pushed PathInterpolator::finish() noexcept {
  Parts& s = *parts_;
  if (!s.failed && s.drain() && !s.finishing) {
    s.finishing = true;
    s.take(s.planner.finish());
  }
  const bool done = s.drain();
  if (s.failed) return s.failure;
  if (!done) return {.status = Pushed::Status::full, .block = s.blocks};
  s.ahead.closed.store(LookAhead::Closed::whole, std::memory_order_release);
  return {.block = s.blocks};
}

PathInterpolator::State PathInterpolator::next(Sample& sample) noexcept {
  Parts& s = *parts_;
  if (s.at_rest_for_good) {
    s.runner.stand(sample);
    return State::stopped;
  }
  const bool ended = s.ended.load(std::memory_order_relaxed);
  const bool held = ended || s.held.load(std::memory_order_relaxed);
  const State out = s.runner.next(held ? 0.0 : s.override_share.load(std::memory_order_relaxed), sample);
  s.override_now.store(s.runner.feed_override(), std::memory_order_relaxed);
  s.at_rest_for_good = ended && out != State::running && out != State::finished;
  return s.at_rest_for_good ? State::stopped : out;
}

void PathInterpolator::hold() noexcept {
  parts_->held.store(true, std::memory_order_relaxed);
}
void PathInterpolator::resume() noexcept {
  parts_->held.store(false, std::memory_order_relaxed);
}
void PathInterpolator::stop() noexcept {
  parts_->ended.store(true, std::memory_order_relaxed);
}
void PathInterpolator::set_override(double share) noexcept {
  if (!std::isnan(share))
    parts_->override_share.store(std::clamp(share, 0.0, override_limits::max), std::memory_order_relaxed);
}
double PathInterpolator::feed_override() const noexcept {
  return parts_->override_now.load(std::memory_order_relaxed);
}
double PathInterpolator::ready_s() const noexcept {
  return parts_->runner.ready_s();
}
bool PathInterpolator::starved() const noexcept {
  return parts_->runner.starved();
}

}  // namespace robomill::path
