#include "robomill/monitor/sensor_agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "robomill/monitor/machine.hpp"

namespace robomill::monitor {
namespace {

// Two sensors read one line so far apart, in widths of a line and of its frequency.
constexpr double one_line = 1.0, one_line_ratio = 0.01;
constexpr double most_of_rotation = 0.15;  // beyond it every line would be a sideband of every other
constexpr double most_sidebands = 8.0;

double to_the_other(double line_hz, double other_hz, double rotation_hz) noexcept {
  const double apart = line_hz - other_hz;
  if (rotation_hz <= 0.0 || std::abs(apart) > (most_sidebands + 0.5) * rotation_hz) return std::abs(apart);
  return std::abs(std::remainder(apart, rotation_hz));
}

}  // namespace

std::vector<SensorPart> parts_by_sensor(const MonitorOptions& options) {
  std::vector<SensorPart> parts(static_cast<std::size_t>(options.sensor_count()));
  const bool one = parts.size() == 1;
  for (int c = 0; c < options.channels; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    if (one) {
      parts.front().channels.push_back(channel);
    } else if (c != options.tachometer_channel) {
      parts[static_cast<std::size_t>(options.sensors[channel])].channels.push_back(channel);
    }
  }
  for (std::size_t s = 0; s < parts.size(); ++s) {
    parts[s].options = options;
    MonitorOptions& own = parts[s].options;
    own.sensors.clear();
    own.agreeing_sensors = 0;
    if (one) continue;
    if (options.tachometer_channel >= 0) {
      own.tachometer_channel = static_cast<int>(parts[s].channels.size());
      parts[s].channels.push_back(static_cast<std::size_t>(options.tachometer_channel));
    }
    own.channels = static_cast<int>(parts[s].channels.size());
    if (!options.machine) continue;
    Machine machine = options.machine->of_sensor(s);
    machine.others.clear();
    own.machine = std::make_shared<const Machine>(std::move(machine));
  }
  return parts;
}

SensorAgreement::Sensor::Sensor(SensorPart&& part)
    : channels(std::move(part.channels)),
      of_vibration(channels.size() - (part.options.tachometer_channel >= 0 ? 1 : 0)),
      detector(std::make_unique<OrderDetector>(part.options)),
      samples(channels.size() * part.options.hop_samples()) {}

double SensorAgreement::Sensor::vote() const noexcept {
  if (!usable || decision.chatter_frequency_hz <= 0.0) return 0.0;
  return std::min(1.0, decision.score);
}

SensorAgreement::SensorAgreement(const MonitorOptions& options)
    : hop_s_(options.hop_s), window_hz_(1.0 / CutTests::history_s(0.0)), agreeing_(options.agreeing_sensors) {
  for (SensorPart& part : parts_by_sensor(options)) sensors_.emplace_back(std::move(part));
}

void SensorAgreement::set_spindle_speed(double rad_per_s) noexcept {
  for (Sensor& sensor : sensors_) sensor.detector->set_spindle_speed(rad_per_s);
}

void SensorAgreement::reset() noexcept {
  for (Sensor& sensor : sensors_) {
    sensor.detector->reset();
    sensor.decision = {};
    sensor.unseen_s = never_s;
    sensor.holds = false;
  }
  chatter_ = false;
}

void SensorAgreement::judge(Sensor& sensor, const Hop& hop) noexcept {
  Hop own{.samples = sensor.samples, .frames = hop.frames, .still = hop.still};
  for (std::size_t i = 0; i < sensor.channels.size(); ++i) {
    const std::size_t channel = sensor.channels[i];
    std::ranges::copy(hop.channel(channel), sensor.samples.begin() + static_cast<std::ptrdiff_t>(i * hop.frames));
    own.bad_channels |= (hop.bad_channels >> channel & 1U) << i;
  }
  const std::uint64_t all = ~std::uint64_t{0} >> (64U - sensor.of_vibration);
  sensor.usable = (~own.bad_channels & all) != 0;
  sensor.decision = {};
  sensor.detector->decide(own, sensor.decision);
  sensor.unseen_s = sensor.sees_the_cut() ? 0.0 : sensor.unseen_s + hop_s_;
}

/// Of the line that has most votes, the strongest; without any vote the sensor that is closest to an alarm.
const SensorAgreement::Sensor& SensorAgreement::leading() const noexcept {
  return *std::ranges::max_element(sensors_, {}, [&](const Sensor& sensor) {
    if (!sensor.usable) return std::array{-1.0, 0.0, 0.0};
    const Explanation& why = sensor.decision.why;
    const double held = why.conditions > 0 ? static_cast<double>(why.held()) / why.conditions : 0.0;
    return std::array{sensor.vote() > 0.0 ? votes(sensor) : 0.0, sensor.decision.score, held};
  });
}

bool SensorAgreement::at_one_line(const Sensor& a, const Sensor& b) const noexcept {
  const double line_hz = a.decision.chatter_frequency_hz;
  const double rotation_hz = a.decision.spindle_speed_rad_per_s / units::revolution;
  double near_hz = std::max(one_line * window_hz_, one_line_ratio * line_hz);
  if (rotation_hz > 0.0) near_hz = std::min(near_hz, most_of_rotation * rotation_hz);
  return to_the_other(b.decision.chatter_frequency_hz, line_hz, rotation_hz) <= near_hz;
}

double SensorAgreement::votes(const Sensor& leader) const noexcept {
  double sum = 0.0;
  for (const Sensor& sensor : sensors_) {
    if (at_one_line(leader, sensor)) sum += sensor.vote();
  }
  return sum;
}

double SensorAgreement::enough() const noexcept {
  const auto count = [&](auto of) { return static_cast<double>(std::ranges::count_if(sensors_, of)); };
  double n = count([](const Sensor& s) { return s.usable && (s.saw_the_cut() || s.vote() > 0.0); });
  if (!std::ranges::any_of(sensors_, [](const Sensor& s) { return s.usable && s.saw_the_cut(); })) {
    n = std::max(1.0, count([](const Sensor& s) { return s.usable; }));
  }
  return agreeing_ > 0 ? std::min<double>(agreeing_, n) : 0.5 * (n + 1.0);
}

/// A tone that another sensor alone shows holds no alarm.
void SensorAgreement::hold(const Sensor& leader, double agreement) noexcept {
  for (Sensor& sensor : sensors_) {
    const auto joins = [&](const Sensor& other) {
      return other.holds && other.chatters() && at_one_line(other, sensor);
    };
    if (!chatter_) {
      sensor.holds = agreement >= 1.0 - 1e-9 && sensor.vote() > 0.0 && at_one_line(leader, sensor);
    } else if (sensor.chatters() && std::ranges::any_of(sensors_, joins)) {
      sensor.holds = true;
    }
  }
  chatter_ = std::ranges::any_of(sensors_, [](const Sensor& s) { return s.holds && s.chatters(); });
}

void SensorAgreement::decide(const Hop& hop, Decision& decision) noexcept {
  for (Sensor& sensor : sensors_) judge(sensor, hop);
  const Sensor& first = leading();
  const double agreement = votes(first) / enough();
  hold(first, agreement);
  const auto holding = [](const Sensor& s) { return s.holds && s.chatters() ? s.decision.score : -1.0; };
  const Sensor& leader = chatter_ ? *std::ranges::max_element(sensors_, {}, holding) : first;

  const Sensor& shown = *std::ranges::max_element(sensors_, {}, &Sensor::usable);
  decision.energy_entropy = shown.decision.energy_entropy;
  decision.bands = shown.decision.bands;
  decision.band_level = shown.decision.band_level;
  decision.threshold = 1.0;
  decision.score = chatter_ ? leader.decision.score : std::min(1.0, agreement);
  decision.state = chatter_ ? State::chatter : agreement > 0.0 ? State::transition : State::stable;
  if (decision.state != State::stable) {
    decision.chatter_frequency_hz = leader.decision.chatter_frequency_hz;
    decision.chatter_frequency_std_hz = leader.decision.chatter_frequency_std_hz;
    decision.channel = static_cast<int>(leader.channels[static_cast<std::size_t>(leader.decision.channel)]);
    decision.synchronous = leader.decision.synchronous;
  }
  decision.why = leader.decision.why;
  decision.why.sensor = 1 + static_cast<int>(&leader - sensors_.data());
  if (decision.why.conditions > 0) decision.why.ask(Quantity::agreement, agreement, 1.0);
  report_speed(decision);
  decision.reason = reason();
}

// Of the sensor that knows it best. A rate is wrong where no sensor finds the speed given.
void SensorAgreement::report_speed(Decision& decision) const noexcept {
  const Sensor* best = nullptr;
  bool seen = false;
  for (const Sensor& sensor : sensors_) {
    if (!sensor.usable) continue;
    const Decision& own = sensor.decision;
    seen = seen || sensor.sees_the_cut();
    if (own.spindle_speed_rad_per_s > 0.0 &&
        (best == nullptr || (sensor.sees_the_cut() && !best->sees_the_cut()) ||
         (sensor.sees_the_cut() == best->sees_the_cut() &&
          own.spindle_speed_std_rad_per_s < best->decision.spindle_speed_std_rad_per_s))) {
      best = &sensor;
    }
  }
  if (best != nullptr) {
    decision.spindle_speed_rad_per_s = best->decision.spindle_speed_rad_per_s;
    decision.spindle_speed_std_rad_per_s = best->decision.spindle_speed_std_rad_per_s;
  }
  if (seen) return;
  decision.faults |= speed_unknown;
  for (const Sensor& sensor : sensors_) {
    if (!sensor.usable || (sensor.decision.faults & wrong_sample_rate) == 0) continue;
    decision.faults |= wrong_sample_rate;
    decision.suggested_sample_rate_hz = sensor.decision.suggested_sample_rate_hz;
    break;
  }
}

/// None where a sensor can judge; else the one that lacks least.
BlindReason SensorAgreement::reason() const noexcept {
  const auto any = [&](BlindReason reason) {
    return std::ranges::any_of(sensors_, [&](const Sensor& s) { return s.usable && s.decision.reason == reason; });
  };
  for (const BlindReason reason :
       {BlindReason::none, BlindReason::learning, BlindReason::speed_unknown, BlindReason::standstill}) {
    if (any(reason)) return reason;
  }
  return BlindReason::none;
}

}  // namespace robomill::monitor
