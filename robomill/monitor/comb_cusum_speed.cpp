#include "robomill/monitor/comb_cusum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace robomill::monitor {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;
constexpr double highest_hz = 500.0;
constexpr double found_score = 1.5;    // of SpeedSearch
constexpr double wide_score = 8.0;     // without a hint
constexpr double mains_share = 5e-3;   // by which the mains, as seen, are off
constexpr double mains_hint = 0.015;   // by which a hint near them may be off
constexpr double certain_score = 8.0;  // beyond the hint
constexpr std::size_t candidates_a_hop = 800;
constexpr double again_s = 60.0;  // of a doubt of the sample rate
constexpr double look_again_s = 0.25;
constexpr double no_comb_s = 0.45;  // after which the test runs without
constexpr double settle_s = 0.06;
constexpr double little = 3e-3;  // change of speed that leaves the baselines as they are
constexpr std::size_t most_misfits = 6;
constexpr std::size_t moving_hops = 4;
constexpr std::size_t steady_hops = 2;  // of a tone where there is no comb
constexpr double drift_doubts = 4.0;    // standard deviations of a slope that is one
constexpr double least_drift = 3e-4;    // of the speed, a hop
constexpr double angle_unrest = 0.01;   // of the angle in a block [rad]

/// 50 or 60 Hz or a whole part of it, as closely as the mains keep it.
bool of_the_mains(double rotation_hz) {
  return std::ranges::any_of(std::array{50.0, 60.0}, [&](double mains_hz) {
    const double order = mains_hz / rotation_hz;
    return order > 0.5 && std::abs(order - std::round(order)) < mains_share * order;
  });
}

}  // namespace

bool CombCusum::trusted() const noexcept {
  if (rotation_hz_ == 0.0) return since_s_ >= no_comb_s;
  return moving_ == 0 && revolutions_ >= settle_turns && since_lock_s_ >= settle_s;
}

void CombCusum::lose() noexcept {
  rotation_hz_ = 0.0;
  since_s_ = 0.0;
  window_ = 0;
  lines_test_.relearn();
}

void CombCusum::lock(double rotation_hz) noexcept {
  const double change = rotation_hz_ > 0.0 ? std::abs(rotation_hz / rotation_hz_ - 1.0) : 1.0;
  rotation_hz_ = known_hz_ = rotation_hz;
  if (std::abs(rotation_hz / hint_hz_ - 1.0) < hint_share) suggested_rate_hz_ = 0.0;
  misfits_ = 0;
  if (change > hint_share) seen_ = 0;
  if (change < 2e-4) return;
  for (Comb& comb : combs_) {
    comb.reset();
    comb.set_harmonics(static_cast<std::size_t>(0.49 * options_.sample_rate_hz / rotation_hz));
  }
  std::fill(innovation_.begin(), innovation_.end(), 0.0);
  replay();
  if (change > little) lines_test_.relearn();
}

void CombCusum::replay() noexcept {
  const std::size_t most =
      std::min(past_.size() - frames_,
               search_.window_samples(std::min(window_ > 0 ? window_ - 1 : 0, SpeedSearch::windows - 1)));
  const std::size_t count = most / block_ * block_;
  const double step = turn * rotation_hz_ / options_.sample_rate_hz;
  const double per_turn = options_.sample_rate_hz / rotation_hz_;
  const double n = static_cast<double>(block_);
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::span past = std::span(past_).subspan(0, count + frames_);
    // What is in the ring ends with this hop, which comb() is still to do.
    search_.last(c, past);
    const std::span left = std::span(past_residual_).subspan(0, count);
    // Twice, so that the beginning is foretold as well as the end.
    for (int pass = 0; pass < 2; ++pass) {
      double angle = 0.0;
      double turns = pass == 0 ? 0.0 : static_cast<double>(count) / per_turn;
      for (std::size_t at = 0; at < count; at += block_, angle += step * n, turns += n / per_turn) {
        combs_[c].run(past.subspan(at, block_), left.subspan(at, block_), angle, step,
                      std::min(1.0, n / per_turn / (1.0 + turns)), 1e30);
      }
      angle_ = std::fmod(angle, turn);
      revolutions_ = static_cast<double>(count) / per_turn;
    }
    double sum = 0.0;
    for (const float x : left) sum += static_cast<double>(x * x);
    rms_[c] = std::sqrt(sum / static_cast<double>(count));
    streams_[c].reset();
    rings_[c].push(left);
    const std::size_t window = std::min(count, 2 * (lines_ - 1));
    for (const float x : left.subspan(count - window)) streams_[c].push(static_cast<double>(x));
  }
  since_lock_s_ = static_cast<double>(count) / options_.sample_rate_hz;
}

void CombCusum::look(std::size_t window, double centre_hz, double share) noexcept {
  everywhere_ = false;
  search_.begin(window, centre_hz * (1.0 - share), centre_hz * (1.0 + share), options_.teeth);
  search_.advance(std::numeric_limits<std::size_t>::max());
}

// A comb at the mains' frequency that the hint does not tell of.
bool CombCusum::hears_the_mains(double rotation_hz) const noexcept {
  return of_the_mains(rotation_hz) && (hint_hz_ <= 0.0 || std::abs(rotation_hz / hint_hz_ - 1.0) > mains_hint);
}

bool CombCusum::convincing() const noexcept {
  return search_.best_score() > found_score && !hears_the_mains(search_.best_hz());
}

bool CombCusum::speed_holds() noexcept {
  if (tachometer_ < channels_) return true;
  if (rotation_hz_ == 0.0) {
    // The tool may have come in gently: look for its comb once more. Without one only a steady tone counts.
    if (hint_hz_ > 0.0) {
      look(2, hint_hz_, hint_share);
      if (search_.best_score() < found_score) look(0, hint_hz_, hint_share);
      if (convincing()) {
        lock(search_.best_hz());
        return false;
      }
    }
    return tone_.begun() || steady_ >= steady_hops;
  }
  // Six turns at least.
  std::size_t window = 0;
  while (window < 2 && search_.window_s(window) * rotation_hz_ < 6.0) ++window;
  look(window, rotation_hz_, 0.1);
  const double now = search_.score(rotation_hz_);
  misfits_ = now < 0.0 ? misfits_ + 1 : 0;
  if (convincing()) {
    seen_hz_[seen_++ % seen_hz_.size()] = search_.best_hz();
    if (speed_drifts()) moving_ = moving_hops;
  } else {
    seen_ = 0;
  }
  const bool moved = convincing() && search_.best_score() > std::max(0.0, now) + 3.0;
  if (moved) {
    if (std::abs(search_.best_hz() / rotation_hz_ - 1.0) > little) moving_ = moving_hops;
    lock(search_.best_hz());
    window_ = window + 1;
    since_s_ = search_.window_s(window);
  }
  return !moved;
}

// Whether the last looks lie apart, or on a line that rises or falls beyond its doubt.
bool CombCusum::speed_drifts() const noexcept {
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
void CombCusum::seek_everywhere() noexcept {
  everywhere_ = true;
  search_.begin(2, 0.4 * hint_hz_, 2.5 * hint_hz_, options_.teeth);
}

void CombCusum::follow_tachometer(const Hop& hop) noexcept {
  search_.push(input_, frames_);
  since_s_ += options_.hop_s;
  since_lock_s_ += options_.hop_s;
  pulses_.push(hop.channel(tachometer_));
  const double now = pulses_.rotation_hz();
  if (now < lowest_hz) {
    if (rotation_hz_ > 0.0) lose();
    return;
  }
  if (rotation_hz_ > 0.0 && std::abs(now / rotation_hz_ - 1.0) < little) {
    rotation_hz_ += 0.1 * (now - rotation_hz_);
  } else {
    lock(now);
  }
}

void CombCusum::find_speed() noexcept {
  search_.push(input_, frames_);
  since_s_ += options_.hop_s;
  since_look_s_ += options_.hop_s;
  since_lock_s_ += options_.hop_s;
  if (moving_ > 0) --moving_;
  if (state_ == State::chatter) return;
  if (search_.searching()) {
    // All speeds, some a hop.
    const double now_score = rotation_hz_ > 0.0 ? search_.score(rotation_hz_) : 0.0;
    const double enough = everywhere_ ? std::max(2.0 * certain_score, 2.0 * now_score) : wide_score;
    if (!search_.advance(candidates_a_hop) || search_.best_score() < enough) return;
    if (hears_the_mains(search_.best_hz())) return;
    if (everywhere_ && std::abs(search_.best_hz() / hint_hz_ - 1.0) > hint_share)
      suggested_rate_hz_ = options_.sample_rate_hz * hint_hz_ / search_.best_hz();
    lock(search_.best_hz());
    return;
  }
  const bool found = rotation_hz_ > 0.0;
  if (window_ < SpeedSearch::windows && since_s_ >= search_.window_s(window_)) {
    if (found) {
      look(window_, rotation_hz_, 0.03 / static_cast<double>(std::size_t{1} << window_));
    } else if (hint_hz_ > 0.0) {
      look(window_, hint_hz_, hint_share);
      if (known_hz_ > 0.0 && search_.best_score() < found_score) look(window_, known_hz_, hint_share);
    } else if (window_ >= 1) {
      search_.begin(window_, lowest_hz, highest_hz, options_.teeth);
    }
    ++window_;
    since_look_s_ = 0.0;
    if (!search_.searching() && convincing()) {
      const double now = found ? search_.score(rotation_hz_) : -1e9;
      if (search_.best_score() > now + 1.0) lock(search_.best_hz());
    }
    return;
  }
  if (found) {
    if (since_s_ >= search_.window_s(0) && !speed_holds()) lines_test_.relearn();
    if (misfits_ >= most_misfits) lose();
    // A weak comb near the hint may be what a strong one elsewhere shows there.
    if (hint_hz_ > 0.0 && since_look_s_ > doubt_s_ && search_.best_score() < certain_score) {
      since_look_s_ = 0.0;
      doubt_s_ = again_s;
      seek_everywhere();
    }
    return;
  }
  if (since_look_s_ < look_again_s || window_ < SpeedSearch::windows) return;
  since_look_s_ = 0.0;
  if (hint_hz_ > 0.0 && !everywhere_) {
    seek_everywhere();
  } else {
    everywhere_ = false;
    window_ = 2;
  }
}

void CombCusum::follow_speed() noexcept {
  if (revolutions_ < 3.0) return;
  double moved = 0.0;
  double weight = 0.0;
  for (std::size_t c = 0; c < channels_; ++c) {
    const double noise = rms_[c] * rms_[c] + 1e-300;
    const double least = 4.0 * noise / static_cast<double>(block_);
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      const std::complex<double> a = combs_[c].amplitude(k);
      if (std::norm(a) < least) continue;
      const double order = static_cast<double>(k);
      // r is a exp(i k δ) - a: what runs ahead has conj(a) g with a positive imaginary part.
      moved += order * (std::conj(a) * combs_[c].innovation(k)).imag() / noise;
      weight += order * order * std::norm(a) / noise;
    }
  }
  if (weight <= 0.0) return;
  // The angle's own unrest against the variance of what is measured.
  const double trust = 1.0 / (1.0 + 2.0 / (static_cast<double>(block_) * weight * angle_unrest * angle_unrest));
  const double ahead = trust * std::clamp(moved / weight, -0.2, 0.2);
  const double block_s = static_cast<double>(block_) / options_.sample_rate_hz;
  angle_ += 0.1 * ahead;
  if (state_ != State::chatter) rotation_hz_ += 0.005 * ahead / (turn * block_s);
}

}  // namespace robomill::monitor
