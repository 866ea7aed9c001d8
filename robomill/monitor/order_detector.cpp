#include "robomill/monitor/order_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/monitor/entropy.hpp"
#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {
namespace {

constexpr double offset_drift_hz = 3.0;  // corner of the high-pass
constexpr double patience_s = 1.0;       // for which no speed need be known
constexpr double least_doubt_s = 1.0;    // for which a comb must be where no speed is
// What a stream is learnt in that may have begun in chatter: at least, and where no calm is seen.
constexpr double least_learning_s = 0.6, most_learning_s = 3.0;
constexpr double slowest_rate = 0.4, fastest_rate = 2.5;

}  // namespace

OrderDetector::OrderDetector(const MonitorOptions& options)
    : options_(options),
      pulses_(options.sample_rate_hz, options.pulses_per_revolution),
      orders_({.sample_rate_hz = options.sample_rate_hz,
               .hop_s = options.hop_s,
               .channels = static_cast<std::size_t>(options.channels),
               .teeth = options.teeth,
               .speed_std_ratio = options.speed_std_ratio,
               .false_alarms_per_hour = options.false_alarms_per_hour,
               .machine = options.machine}),
      samples_(static_cast<std::size_t>(options.channels) * options.hop_samples()),
      mean_(static_cast<std::size_t>(options.channels)),
      bands_(static_cast<std::size_t>(options.bands)) {
  set_spindle_speed(options.spindle_speed_rad_per_s);
}

void OrderDetector::set_spindle_speed(double rad_per_s) noexcept {
  hint_hz_ = rad_per_s / units::revolution;
  if (hint_hz_ >= 0.5 * options_.sample_rate_hz) hint_hz_ = 0.0;  // none of its multiples can be seen
  orders_.set_hint(hint_hz_);
}

void OrderDetector::reset() noexcept {
  pulses_.reset();
  orders_.reset();
  std::ranges::fill(mean_, 0.0);
  first_ = true;
  seen_s_ = unknown_s_ = doubt_s_ = suggested_rate_hz_ = 0.0;
}

void OrderDetector::high_pass(const Hop& hop) noexcept {
  const double share = 1.0 - std::exp(-units::revolution * offset_drift_hz / options_.sample_rate_hz);
  for (std::size_t c = 0; c < mean_.size(); ++c) {
    const auto from = hop.channel(c);
    if (first_) {
      for (const double x : from) mean_[c] += x / static_cast<double>(hop.frames);
    }
    for (std::size_t i = 0; i < hop.frames; ++i) {
      mean_[c] += share * (from[i] - mean_[c]);
      samples_[c * hop.frames + i] = static_cast<float>(from[i] - mean_[c]);
    }
  }
  first_ = false;
}

// The last pulse of a spindle that stops is followed by none: after the time between two at the slowest speed it rests,
// until they give a speed again.
void OrderDetector::count_pulses(const Hop& hop) noexcept {
  pulses_.push(hop.channel(static_cast<std::size_t>(options_.tachometer_channel)));
  const double rotation_hz = pulses_.rotation_hz();
  const double slowest_hz = options_.min_speed_rad_per_s / units::revolution;
  if (rotation_hz > 0.0) {
    rests_ = rotation_hz < slowest_hz;
  } else if (pulses_.quiet_s() * slowest_hz * options_.pulses_per_revolution > 1.0) {
    rests_ = true;
  }
  if (rotation_hz > 0.0 && !rests_) orders_.measured(rotation_hz, pulses_.std_ratio());
}

void OrderDetector::decide(const Hop& hop, Decision& decision) noexcept {
  std::uint64_t bad_channels = hop.bad_channels;
  if (options_.tachometer_channel >= 0) {
    count_pulses(hop);
    bad_channels |= std::uint64_t{1} << options_.tachometer_channel;
  }
  const bool still = hop.still || rests_;
  high_pass(hop);
  const CutTests::Verdict orders = orders_.step(samples_, hop.frames, bad_channels, still);
  decision.why = orders.why;
  decision.threshold = 1.0;
  decision.score = orders.score;
  decision.state = orders.chatter ? State::chatter : orders.score > 0.0 ? State::transition : State::stable;
  if (decision.state != State::stable) {
    decision.chatter_frequency_hz = orders.frequency_hz;
    decision.chatter_frequency_std_hz = orders.frequency_std_hz;
    decision.channel = static_cast<int>(orders.channel);
    decision.synchronous = orders.synchronous;
  }
  if (still) {
    decision.reason = BlindReason::standstill;
    unknown_s_ = doubt_s_ = suggested_rate_hz_ = 0.0;
  } else {
    report_speed(orders, decision);
  }
  report_learning(bad_channels, orders, decision);
  report_bands(bad_channels, decision);
}

void OrderDetector::report_speed(const CutTests::Verdict& orders, Decision& decision) noexcept {
  decision.spindle_speed_rad_per_s = units::revolution * orders.rotation_hz;
  decision.spindle_speed_std_rad_per_s = decision.spindle_speed_rad_per_s * orders.rotation_std_ratio;
  if (!orders.known) decision.faults |= speed_unknown;
  unknown_s_ = hint_hz_ > 0.0 || orders.known ? 0.0 : unknown_s_ + options_.hop_s;
  if (unknown_s_ > patience_s) decision.reason = BlindReason::speed_unknown;
  doubt_the_sample_rate(orders, decision);
}

// Until then a stream that begins in chatter looks like one that is stable. Samples that are lost teach nothing.
void OrderDetector::report_learning(std::uint64_t bad_channels, const CutTests::Verdict& orders,
                                    Decision& decision) noexcept {
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - options_.channels);
  if ((~bad_channels & all) != 0) seen_s_ += options_.hop_s;
  const double seen_s = seen_s_ + 1e-9;
  const bool learning = seen_s < least_learning_s || (!orders.calm_known && seen_s < most_learning_s);
  if (learning && decision.reason == BlindReason::none) decision.reason = BlindReason::learning;
}

// Where the comb of the speed given is not there, but another: at another sample rate it would be that one.
void OrderDetector::doubt_the_sample_rate(const CutTests::Verdict& orders, Decision& decision) noexcept {
  if (orders.explained || hint_hz_ == 0.0) doubt_s_ = suggested_rate_hz_ = 0.0;
  if (orders.comb_hz > 0.0) doubt_s_ += options_.hop_s;
  // Most often it is tooth passing that repeats.
  for (const double rotation_hz : {orders.comb_hz / std::max(1, options_.teeth), orders.comb_hz}) {
    const double ratio = hint_hz_ > 0.0 ? rotation_hz / hint_hz_ : 1.0;
    if (std::abs(ratio - 1.0) < SpeedTracker::reach || ratio < slowest_rate || ratio > fastest_rate) continue;
    if (doubt_s_ >= least_doubt_s) suggested_rate_hz_ = options_.sample_rate_hz / ratio;
    break;
  }
  if (suggested_rate_hz_ == 0.0) return;
  decision.faults |= wrong_sample_rate;
  decision.suggested_sample_rate_hz = suggested_rate_hz_;
}

void OrderDetector::report_bands(std::uint64_t bad_channels, Decision& decision) noexcept {
  decision.bands = options_.bands;
  std::array<double, std::tuple_size_v<decltype(decision.band_level)>> level = {};
  const double lines_a_band =
      0.5 * options_.sample_rate_hz / static_cast<double>(options_.bands) / orders_.spectrum(0).step_hz;
  for (std::size_t c = 0; c < mean_.size(); ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    const Spectrum& spectrum = orders_.spectrum(c);
    std::ranges::fill(bands_, 0.0);
    for (std::size_t i = spectrum.first_line(); i < spectrum.line.size(); ++i) {
      const auto band = std::min(bands_.size() - 1, static_cast<std::size_t>(static_cast<double>(i) / lines_a_band));
      bands_[band] += 0.5 * spectrum.energy_share() * static_cast<double>(std::norm(spectrum.line[i]));
    }
    decision.energy_entropy += energy_entropy(bands_, options_.entropy);
    for (std::size_t b = 0; b < bands_.size(); ++b) level[b] += bands_[b];
  }
  for (std::size_t b = 0; b < bands_.size(); ++b) decision.band_level.at(b) = static_cast<float>(std::sqrt(level[b]));
}

}  // namespace robomill::monitor
