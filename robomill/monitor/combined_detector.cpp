#include "robomill/monitor/combined_detector.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::monitor {
namespace {

constexpr double offset_drift_hz = 3.0;   // corner of the high-pass
constexpr double bears_out = 0.03;        // of the synchronous energy, in lines beside the orders
constexpr double bears_out_unsure = 0.2;  // the same where no speed is given, and the comb found may miss orders
constexpr double patience_s = 1.0;        // for which no speed need be known
constexpr double faint_energy = 0.01;     // of the loudest energy
constexpr double energy_memory_s = 10.0;
constexpr double hint_is_off = 0.07;
constexpr double order_width_hz = 3.5;
constexpr int low_multiples = 5;
constexpr double leaving_swing = 3.0;  // of the synchronous energy in 0.3 s, by itself
constexpr double leaving_swing_unsure = 1.0;

}  // namespace

CombinedDetector::CombinedDetector(const MonitorOptions& options)
    : options_(options),
      pulses_(options.sample_rate_hz, options.pulses_per_revolution),
      growth_(options),
      orders_({.sample_rate_hz = options.sample_rate_hz,
               .hop_s = options.hop_s,
               .channels = static_cast<std::size_t>(options.channels),
               .teeth = options.teeth,
               .speed_std_ratio = options.speed_std_ratio}),
      samples_(static_cast<std::size_t>(options.channels) * options.hop_samples()),
      mean_(static_cast<std::size_t>(options.channels)) {
  set_spindle_speed(options.spindle_speed_rad_per_s);
}

void CombinedDetector::set_spindle_speed(double rad_per_s) noexcept {
  growth_.set_spindle_speed(rad_per_s);
  hint_hz_ = sought_hz_ = rad_per_s / units::revolution;
  orders_.set_hint(hint_hz_);
}

void CombinedDetector::reset() noexcept {
  pulses_.reset();
  growth_.reset();
  orders_.reset();
  std::ranges::fill(mean_, 0.0);
  first_ = true;
  accepted_ = false;
  loudest_ = unknown_s_ = 0.0;
}

void CombinedDetector::high_pass(const Hop& hop) noexcept {
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

void CombinedDetector::decide(const Hop& given, Decision& decision) noexcept {
  Hop hop = given;
  if (options_.tachometer_channel >= 0) {
    const auto channel = static_cast<std::size_t>(options_.tachometer_channel);
    pulses_.push(hop.channel(channel));
    hop.bad_channels |= std::uint64_t{1} << channel;
    hop.measured_rotation_hz = pulses_.rotation_hz();
    hop.measured_std_ratio = pulses_.std_ratio();
  }
  growth_.decide(hop, decision);
  high_pass(hop);
  if (hop.measured_rotation_hz.value_or(0.0) > 0.0) orders_.measured(*hop.measured_rotation_hz, hop.measured_std_ratio);
  judge(orders_.step(samples_, hop.frames, hop.bad_channels), decision);
}

// A low multiple of tooth passing, at the known speed.
bool CombinedDetector::is_the_cut(const RatioTest::Verdict& orders, double frequency_hz) const noexcept {
  if (!orders.known || orders.rotation_hz <= 0.0) return false;
  const double near = std::max(1.0, std::round(frequency_hz / orders.rotation_hz));
  if (std::abs(frequency_hz - near * orders.rotation_hz) > order_width_hz) return false;
  const auto k = static_cast<int>(near);
  const int teeth = std::max(1, options_.teeth);
  return k % teeth == 0 && k <= low_multiples * teeth;
}

// Whether the orders bear out an alarm of CombCusum.
bool CombinedDetector::borne_out(const RatioTest::Verdict& orders, double frequency_hz) const noexcept {
  if (orders.swing > leaving_swing || is_the_cut(orders, frequency_hz)) return false;
  if (hint_hz_ == 0.0) return orders.known && orders.ratio > bears_out_unsure && orders.swing < leaving_swing_unsure;
  // A lone line of high order may have been taken for the comb, as a drill's chatter is.
  if (orders.known) return orders.ratio > bears_out || orders.one_line;
  return orders.energy > faint_energy * loudest_;
}

void CombinedDetector::judge(const RatioTest::Verdict& orders, Decision& decision) noexcept {
  if (orders.rotation_hz > 0.0) {
    decision.spindle_speed_rad_per_s = units::revolution * orders.rotation_hz;
    decision.spindle_speed_std_rad_per_s = decision.spindle_speed_rad_per_s * orders.rotation_std_ratio;
  }
  // CombCusum seeks its speed within 7 % of the hint.
  if (orders.known && orders.rotation_hz > 0.0 && !orders.chatter &&
      std::abs(orders.rotation_hz / sought_hz_ - 1.0) > hint_is_off) {
    sought_hz_ = orders.rotation_hz;
    growth_.set_spindle_speed(units::revolution * sought_hz_);
  }
  if (orders.known) decision.faults &= ~static_cast<std::uint32_t>(speed_unknown);
  loudest_ = std::max(orders.energy, loudest_ * (1.0 - options_.hop_s / energy_memory_s));
  const bool grew = decision.state == State::chatter;
  accepted_ = grew && (accepted_ || borne_out(orders, decision.chatter_frequency_hz));
  if (orders.chatter || (decision.state == State::stable && orders.pending)) {
    decision.state = orders.chatter ? State::chatter : State::transition;
    decision.chatter_frequency_hz = orders.frequency_hz;
    decision.chatter_frequency_std_hz = orders.frequency_std_hz;
    decision.channel = static_cast<int>(orders.channel);
    decision.synchronous = orders.synchronous;
  } else if (grew && !accepted_) {
    decision.state = State::transition;
  }
  // The score is that of CombCusum: what the orders say holds it on its side of the threshold.
  decision.score = decision.state == State::chatter ? std::max(decision.score, 1.001 * decision.threshold)
                                                    : std::min(decision.score, decision.threshold);
  unknown_s_ = hint_hz_ > 0.0 || orders.known ? 0.0 : unknown_s_ + options_.hop_s;
  if (unknown_s_ > patience_s) decision.reason = BlindReason::speed_unknown;
}

}  // namespace robomill::monitor
