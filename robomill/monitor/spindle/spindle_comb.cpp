#include "robomill/monitor/spindle/spindle_comb.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/monitor/spindle/spindle.hpp"

namespace robomill::monitor {
namespace {

constexpr double memory_s = 0.25;
constexpr double settle_turns = 4.0;
constexpr double settle_s = 0.06;
constexpr double steer_turns = 3.0;       // before which there is no phase to go by
constexpr double angle_unrest = 0.01;     // of the angle in a block [rad]
constexpr double most_ahead = 0.2;        // [rad]
constexpr std::size_t coherent = 3;       // hops in which a part of the residual stays in phase with the spindle
constexpr double agreement_of_two = 0.7;  // of their mean's power to the mean of their powers
constexpr double agreement_of_three = 0.5;
constexpr double no_bound = 1e30;

}  // namespace

SpindleComb::SpindleComb(const MonitorOptions& options, std::size_t shortest_past, std::size_t longest_past)
    : rate_hz_(options.sample_rate_hz),
      hop_s_(options.hop_s),
      channels_(static_cast<std::size_t>(options.channels)),
      frames_(options.hop_samples()),
      block_(std::min(std::max<std::size_t>(8, frames_ / 4), shortest_past)),
      teeth_(static_cast<std::size_t>(std::max(options.teeth, 1))),
      most_(
          std::min(most_harmonics, static_cast<std::size_t>(0.5 * options.sample_rate_hz / SpindleTracker::lowest_hz))),
      combs_(channels_, Comb(most_)),
      past_residual_(longest_past),
      rms_(channels_),
      innovation_(channels_ * coherent * most_) {}

void SpindleComb::reset() noexcept {
  forget();
  std::fill(rms_.begin(), rms_.end(), 0.0);
  angle_ = 0.0;
}

void SpindleComb::forget() noexcept {
  for (Comb& each : combs_) each.reset();
  std::fill(innovation_.begin(), innovation_.end(), 0.0);
  revolutions_ = learnt_s_ = 0.0;
}

bool SpindleComb::settled() const noexcept {
  return revolutions_ >= settle_turns && learnt_s_ >= settle_s;
}

void SpindleComb::begin_hop() noexcept {
  hop_ = (hop_ + 1) % coherent;
  learnt_s_ += hop_s_;
}

std::span<std::complex<double>> SpindleComb::innovation(std::size_t channel, std::size_t hop) noexcept {
  return std::span(innovation_).subspan((channel * coherent + hop) * most_, most_);
}

void SpindleComb::run_block(const Hop& hop, std::span<float> residual, std::size_t first, double rotation_hz) noexcept {
  const std::size_t count = std::min(block_, frames_ - first);
  const double step = units::revolution * rotation_hz / rate_hz_;
  const double per_turn = rate_hz_ / rotation_hz;
  const double n = static_cast<double>(count);
  const double steady = 1.0 - std::exp(-n / (memory_s * rate_hz_));
  const double fast = std::min(1.0, n / per_turn / (1.0 + revolutions_));
  const double gain = hop.learns ? std::max(steady, fast) : 0.0;
  const bool young = revolutions_ < settle_turns;
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::span<float> left = residual.subspan(c * frames_ + first, count);
    if ((hop.bad_channels >> c & 1U) != 0) {
      std::fill(left.begin(), left.end(), 0.0F);
      continue;
    }
    combs_[c].run(hop.samples.subspan(c * frames_ + first, count), left, angle_, step, gain,
                  young ? no_bound : 4.0 * rms_[c]);
    double sum = 0.0;
    for (const float x : left) sum += static_cast<double>(x * x);
    const double now = std::sqrt(sum / n);
    rms_[c] += young ? 0.5 * (now - rms_[c]) : 0.03 * (std::min(now, 3.0 * rms_[c]) - rms_[c]);
    const std::span<std::complex<double>> sums = innovation(c, hop_);
    for (std::size_t k = 1; k <= combs_[c].harmonics(); ++k) {
      if (first == 0) sums[k - 1] = 0.0;
      sums[k - 1] += combs_[c].innovation(k) * (n / static_cast<double>(frames_));
    }
  }
  angle_ = std::fmod(angle_ + step * n, units::revolution);
  revolutions_ += n / per_turn;
}

// By how much the spindle runs ahead of the angle, as far as it is to be trusted.
double SpindleComb::ahead() const noexcept {
  if (revolutions_ < steer_turns) return 0.0;
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
  if (weight <= 0.0) return 0.0;
  // The angle's own unrest against the variance of what is measured.
  const double trust = 1.0 / (1.0 + 2.0 / (static_cast<double>(block_) * weight * angle_unrest * angle_unrest));
  return trust * std::clamp(moved / weight, -most_ahead, most_ahead);
}

double SpindleComb::run(const Hop& hop, std::span<float> residual) noexcept {
  const double block_s = static_cast<double>(block_) / rate_hz_;
  double rotation_hz = hop.rotation_hz;
  for (std::size_t first = 0; first < frames_; first += block_) {
    run_block(hop, residual, first, rotation_hz);
    const double by = ahead();
    angle_ += 0.1 * by;
    if (hop.steers) rotation_hz += 0.005 * by / (units::revolution * block_s);
  }
  return rotation_hz;
}

std::complex<double> SpindleComb::coherent_mean(std::size_t channel, std::size_t k) const noexcept {
  const std::complex<double>* sums = innovation_.data() + channel * coherent * most_ + k - 1;
  const std::complex<double> last = sums[hop_ * most_];
  const std::complex<double> before = sums[(hop_ + 2) % coherent * most_];
  const std::complex<double> first = sums[(hop_ + 1) % coherent * most_];
  const std::complex<double> two = 0.5 * (last + before);
  const std::complex<double> three = (last + before + first) / 3.0;
  const bool pair = std::norm(two) > agreement_of_two * 0.5 * (std::norm(last) + std::norm(before));
  const bool all =
      std::norm(three) > agreement_of_three * (std::norm(last) + std::norm(before) + std::norm(first)) / 3.0;
  return pair && std::norm(two) > std::norm(three) ? two : all ? three : std::complex<double>(0.0);
}

void SpindleComb::lags(std::size_t channel, double whole, bool learns, std::span<double> power) noexcept {
  Comb& comb = combs_[channel];
  double lag = 0.0;
  double squares = 1e-300;
  for (std::size_t k = 1; k <= comb.harmonics(); ++k) {
    const double own = std::norm(comb.amplitude(k));
    lag += own * std::norm(coherent_mean(channel, k));
    squares += own * own;
  }
  const double noise = 4.0 * rms_[channel] * rms_[channel] / static_cast<double>(frames_ * coherent);
  for (std::size_t k = 1; k <= comb.harmonics(); ++k) {
    power[k - 1] = 0.0;
    const std::complex<double> mean = coherent_mean(channel, k);
    const double here = std::norm(mean);
    if (here <= 4.0 * noise) continue;
    const double own = std::norm(comb.amplitude(k));
    power[k - 1] = std::min(here, std::max(25.0 * lag / squares * own, 0.0003 * whole));
    // Of a harmonic that is no multiple of the teeth, only what is less than twice its own power.
    if (learns && (k % teeth_ == 0 || own > 0.5 * here)) comb.correct(k, 0.3 * std::sqrt(power[k - 1] / here) * mean);
  }
}

std::span<const float> SpindleComb::learn(std::size_t channel, std::span<const float> past,
                                          double rotation_hz) noexcept {
  const std::size_t count = past.size() / block_ * block_;
  past = past.last(count);
  const std::span<float> left = std::span(past_residual_).first(count);
  const double step = units::revolution * rotation_hz / rate_hz_;
  const double per_turn = rate_hz_ / rotation_hz;
  const double n = static_cast<double>(block_);
  Comb& comb = combs_[channel];
  comb.reset();
  comb.set_harmonics(static_cast<std::size_t>(0.49 * rate_hz_ / rotation_hz));
  for (std::size_t hop = 0; hop < coherent; ++hop) {
    const std::span<std::complex<double>> sums = innovation(channel, hop);
    std::fill(sums.begin(), sums.end(), 0.0);
  }
  double angle = 0.0;
  // Twice, so that the beginning is predicted as well as the end.
  for (int pass = 0; pass < 2; ++pass) {
    angle = 0.0;
    double turns = pass == 0 ? 0.0 : static_cast<double>(count) / per_turn;
    for (std::size_t at = 0; at < count; at += block_, angle += step * n, turns += n / per_turn) {
      comb.run(past.subspan(at, block_), left.subspan(at, block_), angle, step,
               std::min(1.0, n / per_turn / (1.0 + turns)), no_bound);
    }
  }
  double sum = 0.0;
  for (const float x : left) sum += static_cast<double>(x * x);
  rms_[channel] = std::sqrt(sum / static_cast<double>(count));
  angle_ = std::fmod(angle, units::revolution);
  revolutions_ = static_cast<double>(count) / per_turn;
  learnt_s_ = static_cast<double>(count) / rate_hz_;
  return left;
}

}  // namespace robomill::monitor
