#include "robomill/monitor/spindle/spindle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "robomill/base/units.hpp"

namespace robomill::monitor {
namespace {

constexpr double highest_hz = 500.0;
constexpr double found_score = 1.5;    // of SpeedSearch
constexpr double wide_score = 8.0;     // without a hint
constexpr double same_hint = 0.01;     // change of a hint that is no other speed: a controller's reading trembles
constexpr double mains_share = 5e-3;   // by which the mains, as seen, are off
constexpr double mains_hint = 0.015;   // by which a hint near them may be off
constexpr double certain_score = 8.0;  // beyond the hint
constexpr std::size_t candidates_a_hop = 800;
constexpr double first_doubt_s = 1.0;  // of the sample rate
constexpr double again_s = 60.0;       // of such a doubt
constexpr double look_again_s = 0.25;
constexpr double no_comb_s = 0.45;  // after which the test runs without
constexpr double same = 2e-4;       // change of speed that leaves the comb as it is
constexpr double little = 3e-3;     // that leaves the baselines as they are
constexpr double least_turns = 6.0;
constexpr std::size_t most_misfits = 6;
constexpr std::size_t moving_hops = 4;
constexpr double drift_doubts = 4.0;  // standard deviations of a slope that is one
constexpr double least_drift = 3e-4;  // of the speed, a hop

/// 50 or 60 Hz or a whole part of it, as closely as the mains keep it.
bool of_the_mains(double rotation_hz) {
  return std::ranges::any_of(std::array{50.0, 60.0}, [&](double mains_hz) {
    const double order = mains_hz / rotation_hz;
    return order > 0.5 && std::abs(order - std::round(order)) < mains_share * order;
  });
}

}  // namespace

SpindleTracker::SpindleTracker(const MonitorOptions& options)
    : rate_hz_(options.sample_rate_hz),
      hop_s_(options.hop_s),
      frames_(options.hop_samples()),
      teeth_(options.teeth),
      search_(options.sample_rate_hz, static_cast<std::size_t>(options.channels)),
      hint_hz_(options.spindle_speed_rad_per_s / units::revolution),
      reported_hz_(hint_hz_),
      doubt_s_(first_doubt_s) {}

void SpindleTracker::set_hint(double rotation_hz) noexcept {
  hint_hz_ = rotation_hz;
  // Step by step a hint that drifts is another one, too.
  if (std::abs(rotation_hz - reported_hz_) <= same_hint * reported_hz_) return;
  reported_hz_ = rotation_hz;
  known_hz_ = 0.0;
}

void SpindleTracker::reset() noexcept {
  search_.reset();
  rotation_hz_ = known_hz_ = since_s_ = since_look_s_ = suggested_rate_hz_ = 0.0;
  window_ = misfits_ = moving_ = seen_ = 0;
  everywhere_ = false;
  doubt_s_ = first_doubt_s;
}

bool SpindleTracker::settled() const noexcept {
  return rotation_hz_ > 0.0 ? moving_ == 0 : since_s_ >= no_comb_s;
}

void SpindleTracker::jumped() noexcept {
  if (rotation_hz_ > 0.0) return;
  since_s_ = 0.0;
  window_ = 0;
}

void SpindleTracker::lose() noexcept {
  rotation_hz_ = 0.0;
  since_s_ = 0.0;
  window_ = 0;
}

SpindleTracker::Change SpindleTracker::lock(double rotation_hz) noexcept {
  const double change = rotation_hz_ > 0.0 ? std::abs(rotation_hz / rotation_hz_ - 1.0) : 1.0;
  rotation_hz_ = known_hz_ = rotation_hz;
  if (std::abs(rotation_hz / hint_hz_ - 1.0) < hint_share) suggested_rate_hz_ = 0.0;
  misfits_ = 0;
  if (change > hint_share) seen_ = 0;
  const std::size_t last_window = std::min(window_ > 0 ? window_ - 1 : 0, longest_past_window);
  return {.locked = true, .past = change < same ? 0 : search_.window_samples(last_window), .relearn = change > little};
}

void SpindleTracker::look(std::size_t window, double centre_hz, double share) noexcept {
  everywhere_ = false;
  search_.begin(window, centre_hz * (1.0 - share), centre_hz * (1.0 + share), teeth_);
  search_.advance(std::numeric_limits<std::size_t>::max());
}

// A comb at the mains' frequency, where the hint gives no such speed.
bool SpindleTracker::detects_the_mains(double rotation_hz) const noexcept {
  return of_the_mains(rotation_hz) && (hint_hz_ <= 0.0 || std::abs(rotation_hz / hint_hz_ - 1.0) > mains_hint);
}

bool SpindleTracker::convincing() const noexcept {
  return search_.best_score() > found_score && !detects_the_mains(search_.best_hz());
}

SpindleTracker::Change SpindleTracker::check() noexcept {
  if (rotation_hz_ == 0.0) {
    if (hint_hz_ <= 0.0) return {};
    look(2, hint_hz_, hint_share);
    if (search_.best_score() < found_score) look(0, hint_hz_, hint_share);
    return convincing() ? lock(search_.best_hz()) : Change{};
  }
  std::size_t window = 0;
  while (window < 2 && search_.window_s(window) * rotation_hz_ < least_turns) ++window;
  look(window, rotation_hz_, 0.1);
  const double now = search_.score(rotation_hz_);
  misfits_ = now < 0.0 ? misfits_ + 1 : 0;
  if (!convincing()) {
    seen_ = 0;
    return {};
  }
  seen_hz_[seen_++ % seen_hz_.size()] = search_.best_hz();
  if (drifts()) moving_ = moving_hops;
  if (search_.best_score() <= std::max(0.0, now) + 3.0) return {};
  if (std::abs(search_.best_hz() / rotation_hz_ - 1.0) > little) moving_ = moving_hops;
  const Change change = lock(search_.best_hz());
  window_ = window + 1;
  since_s_ = search_.window_s(window);
  return change;
}

// Whether the last looks lie apart, or on a line that rises or falls beyond its doubt.
bool SpindleTracker::drifts() const noexcept {
  const std::size_t n = std::min(seen_, seen_hz_.size());
  const auto last = std::span(seen_hz_).first(n);
  const auto [low, high] = std::minmax_element(last.begin(), last.end());
  if (*high > (1.0 + little) * *low && *high < 1.2 * *low) return true;
  if (n < seen_hz_.size()) return false;
  const double middle = 0.5 * static_cast<double>(n - 1);
  double mean = 0.0;
  double slope = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double from_middle = static_cast<double>(i) - middle;
    mean += last[i] / static_cast<double>(n);
    slope += from_middle * last[(seen_ + i) % n];
    squares += from_middle * from_middle;
  }
  slope /= squares;
  double rest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = last[(seen_ + i) % n] - mean - slope * (static_cast<double>(i) - middle);
    rest += d * d;
  }
  const double doubt = std::sqrt(rest / static_cast<double>(n - 2) / squares);
  return std::abs(slope) > std::max(drift_doubts * doubt, least_drift * mean);
}

// Far from the hint there may be a comb if the sample rate is not what it is said to be.
void SpindleTracker::seek_everywhere() noexcept {
  everywhere_ = true;
  search_.begin(2, 0.4 * hint_hz_, 2.5 * hint_hz_, teeth_);
}

SpindleTracker::Change SpindleTracker::take_measured(double now_hz) noexcept {
  if (now_hz < lowest_hz) {
    if (rotation_hz_ == 0.0) return {};
    lose();
    return {.relearn = true};
  }
  if (rotation_hz_ == 0.0 || std::abs(now_hz / rotation_hz_ - 1.0) >= little) return lock(now_hz);
  rotation_hz_ += 0.1 * (now_hz - rotation_hz_);
  return {};
}

SpindleTracker::Change SpindleTracker::step(std::span<const float> samples, std::optional<double> measured_hz,
                                            bool chatters) noexcept {
  search_.push(samples, frames_);
  since_s_ += hop_s_;
  if (measured_hz) return take_measured(*measured_hz);
  since_look_s_ += hop_s_;
  if (moving_ > 0) --moving_;
  if (chatters) return {};
  if (search_.searching()) return search_on();
  if (window_ < SpeedSearch::windows && since_s_ >= search_.window_s(window_)) return look_closer();
  if (rotation_hz_ > 0.0) return hold();
  look_again();
  return {};
}

// All speeds, some a hop.
SpindleTracker::Change SpindleTracker::search_on() noexcept {
  const double now_score = rotation_hz_ > 0.0 ? search_.score(rotation_hz_) : 0.0;
  const double enough = everywhere_ ? std::max(2.0 * certain_score, 2.0 * now_score) : wide_score;
  if (!search_.advance(candidates_a_hop) || search_.best_score() < enough) return {};
  if (detects_the_mains(search_.best_hz())) return {};
  if (everywhere_ && std::abs(search_.best_hz() / hint_hz_ - 1.0) > hint_share)
    suggested_rate_hz_ = rate_hz_ * hint_hz_ / search_.best_hz();
  return lock(search_.best_hz());
}

// In a longer window, once it is full.
SpindleTracker::Change SpindleTracker::look_closer() noexcept {
  const bool found = rotation_hz_ > 0.0;
  if (found) {
    look(window_, rotation_hz_, 0.03 / static_cast<double>(std::size_t{1} << window_));
  } else if (hint_hz_ > 0.0) {
    look(window_, hint_hz_, hint_share);
    if (known_hz_ > 0.0 && search_.best_score() < found_score) look(window_, known_hz_, hint_share);
  } else if (window_ >= 1) {
    search_.begin(window_, lowest_hz, highest_hz, teeth_);
  }
  ++window_;
  since_look_s_ = 0.0;
  if (search_.searching() || !convincing()) return {};
  const double now = found ? search_.score(rotation_hz_) : -1e9;
  return search_.best_score() > now + 1.0 ? lock(search_.best_hz()) : Change{};
}

SpindleTracker::Change SpindleTracker::hold() noexcept {
  Change change;
  if (since_s_ >= search_.window_s(0)) {
    change = check();
    change.relearn = change.locked;
  }
  if (misfits_ >= most_misfits) {
    lose();
    change.relearn = true;
  }
  // A weak comb near the hint may be what a strong one elsewhere shows there.
  if (hint_hz_ > 0.0 && since_look_s_ > doubt_s_ && search_.best_score() < certain_score) {
    since_look_s_ = 0.0;
    doubt_s_ = again_s;
    seek_everywhere();
  }
  return change;
}

void SpindleTracker::look_again() noexcept {
  if (since_look_s_ < look_again_s || window_ < SpeedSearch::windows) return;
  since_look_s_ = 0.0;
  if (hint_hz_ > 0.0 && !everywhere_) {
    seek_everywhere();
  } else {
    everywhere_ = false;
    window_ = 2;
  }
}

}  // namespace robomill::monitor
