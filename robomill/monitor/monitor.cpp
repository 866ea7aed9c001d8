#include "robomill/monitor/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/monitor/detector.hpp"
#include "robomill/monitor/explanation.hpp"
#include "robomill/monitor/machine.hpp"
#include "robomill/monitor/order_detector.hpp"
#include "robomill/monitor/orders/cut_tests.hpp"
#include "robomill/monitor/published/entropy_detector.hpp"
#include "robomill/monitor/sensor_agreement.hpp"
#include "robomill/monitor/signal_validation.hpp"

namespace robomill::monitor {
namespace {

constexpr double silence = 1e-8;  // share of the loudest channel's power below which a channel is dead
// Hops in a row at the converter's limit that an impact does not make.
constexpr std::size_t clipped_hops = 4;

constexpr Name<State> state_names[] = {
    {"stable", State::stable}, {"transition", State::transition}, {"chatter", State::chatter}, {"blind", State::blind}};
constexpr Name<BlindReason> reason_names[] = {{"none", BlindReason::none},
                                              {"no-signal", BlindReason::no_signal},
                                              {"clipped", BlindReason::clipped},
                                              {"speed-unknown", BlindReason::speed_unknown},
                                              {"gap", BlindReason::gap},
                                              {"standstill", BlindReason::standstill},
                                              {"overloaded", BlindReason::overloaded},
                                              {"learning", BlindReason::learning}};
constexpr Name<SynchronousChatter> synchronous_names[] = {{"none", SynchronousChatter::none},
                                                          {"locked", SynchronousChatter::locked},
                                                          {"period-doubling", SynchronousChatter::period_doubling}};
constexpr Name<Fault> names_of_faults[] = {{"not-finite", Fault::not_finite},
                                           {"stuck", Fault::stuck},
                                           {"clipped", Fault::clipped},
                                           {"dead-channel", Fault::dead_channel},
                                           {"wrong-sample-rate", Fault::wrong_sample_rate},
                                           {"speed-unknown", Fault::speed_unknown}};

constexpr double fastest_min_speed_rpm = 100'000.0;
constexpr double same_rate = 0.01;  // as the machine's: less than a cell at the 50th of them

void require_between(const char* field, double number, double low, double high, const char* unit, const char* rule) {
  if (!(number >= low && number <= high)) throw InvalidInput(field, number, unit, rule);
}

/// Of a time: so many samples of it.
void require_samples(const char* field, double seconds, double rate_hz, int least, const char* usual) {
  constexpr int most = 1'000'000;
  const double samples = std::round(seconds * rate_hz);
  if (!(samples >= least)) {
    throw InvalidInput(field, samples, "samples", fmt::format("must be at least {} samples long", least),
                       fmt::format("Is it in s? {} is usual", usual));
  }
  if (samples > most) {
    throw InvalidInput(field, samples, "samples", fmt::format("must be at most {} samples long", most),
                       fmt::format("Is it in us? {} is usual", usual));
  }
}

/// Each from 0 on has a channel of vibration.
void require_sensors(const MonitorOptions& options) {
  constexpr int most = 8;
  if (options.sensors.empty()) return;
  if (options.sensors.size() != static_cast<std::size_t>(options.channels)) {
    throw InvalidInput("sensors", static_cast<double>(options.sensors.size()), "", "must be one a channel");
  }
  std::array<int, most> channels = {};
  for (int c = 0; c < options.channels; ++c) {
    const int of = options.sensors[static_cast<std::size_t>(c)];
    if (c == options.tachometer_channel) continue;
    require_between("sensors", of, 0.0, most - 1.0, "", "must be in [0, 7]");
    ++channels.at(static_cast<std::size_t>(of));
  }
  const int count = options.sensor_count();
  for (int sensor = 0; sensor < count; ++sensor) {
    if (channels.at(static_cast<std::size_t>(sensor)) > 0) continue;
    throw InvalidInput("sensors", sensor, "", "must have a channel of vibration each");
  }
  if (count > 1 && options.kind != Kind::comb_cusum) {
    throw InvalidInput("sensors", count, "", "must be one with energy-entropy", "Its threshold holds for one sensor");
  }
}

void require_same_signal(const Machine& machine, const MonitorOptions& options) {
  const char* const hint = "Learn the machine with this sensor: robomill monitor --learn";
  const double rate_hz = options.sample_rate_hz;
  if (std::abs(machine.sample_rate_hz - rate_hz) > same_rate * rate_hz) {
    throw InvalidInput(
        "machine",
        fmt::format("was learnt at {:.6g} Hz, and the samples come at {:.6g} Hz", machine.sample_rate_hz, rate_hz),
        hint);
  }
  const auto sensors = static_cast<std::size_t>(options.sensor_count());
  if (machine.sensors() != sensors) {
    throw InvalidInput("machine",
                       fmt::format("is of {} sensors, and the samples are of {}", machine.sensors(), sensors), hint);
  }
  for (std::size_t s = 0; s < sensors; ++s) {
    int channels = 0;
    for (int c = 0; c < options.channels; ++c) {
      const bool of = options.sensors.empty() || options.sensors[static_cast<std::size_t>(c)] == static_cast<int>(s);
      channels += c != options.tachometer_channel && of ? 1 : 0;
    }
    const int learnt = machine.of_sensor(s).channels;
    if (learnt == channels) continue;
    const std::string of = sensors > 1 ? fmt::format(" of sensor {}", s + 1) : "";
    throw InvalidInput(
        "machine",
        fmt::format("was learnt with {} channels of vibration{}, and the samples have {}", learnt, of, channels), hint);
  }
}

std::unique_ptr<Detector> make_detector(const MonitorOptions& options) {
  if (options.kind == Kind::energy_entropy) return std::make_unique<EntropyDetector>(options);
  if (options.sensor_count() > 1) return std::make_unique<SensorAgreement>(options);
  return std::make_unique<OrderDetector>(options);
}

}  // namespace

void MonitorOptions::validate() const {
  require_between("sample_rate_hz", sample_rate_hz, 100.0, 1e6, "Hz", "must be in [100, 1e6]");
  require_between("channels", channels, 1.0, 64.0, "", "must be in [1, 64]");
  require_between("tachometer_channel", tachometer_channel, -1.0, channels - 1.0, "",
                  "must name a channel, from 0, or be -1");
  if (tachometer_channel >= 0 && channels == 1) {
    throw InvalidInput("tachometer_channel", tachometer_channel, "", "leaves no channel of vibration");
  }
  require_between("pulses_per_revolution", pulses_per_revolution, 1.0, 10'000.0, "", "must be in [1, 10000]");
  require_non_negative("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  const double pulses_hz = pulses_per_revolution * spindle_speed_rad_per_s / units::revolution;
  if (tachometer_channel >= 0 && pulses_hz > 0.5 * sample_rate_hz) {
    throw InvalidInput("pulses_per_revolution", pulses_per_revolution, "",
                       "gives more pulses than half the sample rate can show",
                       "Is spindle_speed_rpm right? Otherwise divide the pulses before they are sampled");
  }
  require_between("min_speed_rad_per_s", min_speed_rad_per_s, slowest_min_speed_rad_per_s,
                  fastest_min_speed_rpm * units::rpm, "rad/s", "must be between 1 and 100000 rpm");
  if (spindle_speed_rad_per_s > 0.0 && spindle_speed_rad_per_s < min_speed_rad_per_s) {
    throw InvalidInput("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s",
                       "must be at least the speed below which the spindle stands still and nothing is judged",
                       "Is it in 1/s? 50 1/s are 3000 rpm");
  }
  require_between("speed_std_ratio", speed_std_ratio, 1e-4, 0.2, "", "must be in [0.0001, 0.2]");
  require_between("teeth", teeth, 0.0, 64.0, "", "must be in [0, 64]");
  require_positive("window_s", window_s, "s");
  require_positive("hop_s", hop_s, "s");
  require_samples("hop_s", hop_s, sample_rate_hz, kind == Kind::energy_entropy ? 16 : 4, "25 ms");
  require_samples("window_s", window_s, sample_rate_hz, kind == Kind::energy_entropy ? 32 : 8, "50 ms");
  if (window_s < hop_s) throw InvalidInput("window_s", window_s, "s", "must be at least hop_s");
  require_between("bands", bands, 2.0, 64.0, "", "must be in [2, 64]");
  if (kind == Kind::energy_entropy && !std::isfinite(threshold)) {
    throw InvalidInput("threshold", "must be finite",
                       "It holds for one form of the entropy, one unit and one sensor: robomill calibrate sets it");
  }
  require_positive("false_alarms_per_hour", false_alarms_per_hour, "1/h");
  require_non_negative("full_scale", full_scale, "");
  require_sensors(*this);
  require_between("agreeing_sensors", agreeing_sensors, 0.0, sensor_count(), "",
                  "must be in [0, the number of sensors]");
  if (machine) require_same_signal(*machine, *this);
}

int MonitorOptions::sensor_count() const noexcept {
  int last = 0;
  for (std::size_t c = 0; c < sensors.size(); ++c) {
    if (static_cast<int>(c) != tachometer_channel) last = std::max(last, sensors[c]);
  }
  return last + 1;
}

std::size_t MonitorOptions::hop_samples() const noexcept {
  return static_cast<std::size_t>(std::lround(hop_s * sample_rate_hz));
}

std::size_t MonitorOptions::window_samples() const noexcept {
  return static_cast<std::size_t>(std::lround(window_s * sample_rate_hz));
}

double MonitorOptions::look_back_s() const noexcept {
  if (kind == Kind::energy_entropy) return std::max(CutTests::history_s(0.0), 2.0 * window_s);
  return CutTests::history_s(spindle_speed_rad_per_s / units::revolution);
}

struct ChatterMonitor::Parts {
  explicit Parts(const MonitorOptions& o)
      : options(o),
        channels(static_cast<std::size_t>(o.channels)),
        hop_frames(o.hop_samples()),
        samples(channels * hop_frames),
        validations(channels, SignalValidation(o)),
        left_out(channels),
        loudest(static_cast<std::size_t>(o.sensor_count())),
        detector(make_detector(o)) {}

  void take(float sample) noexcept {
    samples[channel * hop_frames + frame] = validations[channel].take(sample);
    frame_is_lost = frame_is_lost && std::isnan(sample);
    if (++channel < channels) return;
    channel = 0;
    if (std::exchange(frame_is_lost, true)) ++lost_frames;
    if (++frame < hop_frames) return;
    frame = 0;
    decide();
  }

  void decide() noexcept {
    const State before = last.state;
    const std::uint64_t hop = last.hop + 1;
    last = {.hop = hop, .time_s = static_cast<double>(hop * hop_frames - 1) / options.sample_rate_hz};
    Hop of{.samples = samples, .frames = hop_frames, .still = still};
    validate(of);
    detector->decide(of, last);
    take_blindness();
    last.changed = last.state != before;
  }

  [[nodiscard]] bool is_vibration(std::size_t c) const noexcept {
    return static_cast<int>(c) != options.tachometer_channel;
  }

  [[nodiscard]] std::size_t sensor_of(std::size_t c) const noexcept {
    return options.sensors.empty() ? 0 : static_cast<std::size_t>(options.sensors[c]);
  }

  /// After a bad hop: until all that is looked back at is good.
  [[nodiscard]] std::size_t left_out_hops() const noexcept {
    return static_cast<std::size_t>(std::ceil(options.look_back_s() / options.hop_s - 1e-9)) - 1;
  }

  /// Faults and level of the hop, which channels are bad, and whether what is left can be judged.
  void validate(Hop& hop) noexcept {
    std::ranges::fill(loudest, 0.0);
    std::uint64_t at_limit = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const std::uint32_t faults = validations[c].hop_faults();
      // Pulses rest at their limits, and are as loud as they are.
      last.faults |= is_vibration(c) ? faults : faults & not_finite;
      if (!is_vibration(c)) continue;
      if ((faults & clipped) != 0) at_limit |= std::uint64_t{1} << c;
      double& of_sensor = loudest[sensor_of(c)];
      of_sensor = std::max(of_sensor, validations[c].variance());
    }
    std::size_t vibration = 0;
    std::size_t bad = 0;
    std::size_t usable = 0;
    std::size_t usable_at_limit = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      if (!is_vibration(c)) continue;
      ++vibration;
      const bool silent = validations[c].variance() < silence * loudest[sensor_of(c)];
      if (silent) last.faults |= dead_channel;
      const bool is_bad = silent || validations[c].bad();
      if (is_bad) ++bad;
      if (is_bad || left_out[c] > 0) {
        hop.bad_channels |= std::uint64_t{1} << c;
        left_out[c] = is_bad ? left_out_hops() : left_out[c] - 1;
      } else {
        ++usable;
        if ((at_limit >> c & 1U) != 0) ++usable_at_limit;
      }
    }
    last.level = level(hop.bad_channels);
    clipped_run = usable > 0 && usable == usable_at_limit ? clipped_run + 1 : 0;
    const bool is_gap = 2 * std::exchange(lost_frames, 0) > hop_frames;
    if (bad == vibration) {
      unusable = is_gap ? BlindReason::gap : BlindReason::no_signal;
    } else if (usable > 0) {
      unusable = clipped_run >= clipped_hops ? BlindReason::clipped : BlindReason::none;
    } else if (unusable != BlindReason::gap) {
      unusable = BlindReason::no_signal;
    }
  }

  /// Rms over the first sensor with a channel that can be used; without one, over the first.
  [[nodiscard]] double level(std::uint64_t bad_channels) const noexcept {
    std::size_t shown = loudest.size();
    for (std::size_t c = 0; c < channels; ++c) {
      if (is_vibration(c) && (bad_channels >> c & 1U) == 0) shown = std::min(shown, sensor_of(c));
    }
    if (shown == loudest.size()) shown = 0;
    double power = 0.0;
    int count = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      if (!is_vibration(c) || sensor_of(c) != shown) continue;
      power += validations[c].variance();
      ++count;
    }
    return std::sqrt(power / count);
  }

  /// What is wrong with the input stands before what the detector lacks; an alarm stands until the detector ends it.
  void take_blindness() noexcept {
    if (unusable != BlindReason::none) last.reason = unusable;
    if (last.state == State::chatter) last.reason = BlindReason::none;
    if (last.reason == BlindReason::none) return;
    last.state = State::blind;
    last.chatter_frequency_hz = last.chatter_frequency_std_hz = 0.0;
    last.channel = 0;
    last.synchronous = SynchronousChatter::none;
  }

  MonitorOptions options;
  std::size_t channels = 1, hop_frames = 1;
  std::vector<double> samples;  // of this hop, channel after channel
  std::size_t frame = 0, channel = 0;
  std::vector<SignalValidation> validations;
  std::vector<std::size_t> left_out;  // hops for which each channel is still left out
  std::vector<double> loudest;        // variance, of each sensor's channels
  std::size_t clipped_run = 0;        // hops in which every usable channel was at its limit
  std::size_t lost_frames = 0;        // of this hop, NaN in every channel
  bool frame_is_lost = true;          // so far
  bool still = false;                 // the spindle
  BlindReason unusable = BlindReason::none;
  std::unique_ptr<Detector> detector;
  Decision last;
};

ChatterMonitor::ChatterMonitor(const MonitorOptions& options) {
  options.validate();
  parts_ = std::make_unique<Parts>(options);
}
ChatterMonitor::~ChatterMonitor() = default;
ChatterMonitor::ChatterMonitor(ChatterMonitor&&) noexcept = default;
ChatterMonitor& ChatterMonitor::operator=(ChatterMonitor&&) noexcept = default;

Decision ChatterMonitor::push(std::span<const float> samples) noexcept {
  for (const float sample : samples) parts_->take(sample);
  return parts_->last;
}

std::size_t ChatterMonitor::frames_to_next_decision() const noexcept {
  return parts_->hop_frames - parts_->frame;
}

void ChatterMonitor::set_spindle_speed(double rad_per_s) noexcept {
  parts_->still = rad_per_s >= 0.0 && rad_per_s < parts_->options.min_speed_rad_per_s;
  if (parts_->still) return;
  parts_->options.spindle_speed_rad_per_s = std::isfinite(rad_per_s) && rad_per_s > 0.0 ? rad_per_s : 0.0;
  parts_->detector->set_spindle_speed(parts_->options.spindle_speed_rad_per_s);
}

void ChatterMonitor::reset() noexcept {
  parts_->frame = 0;
  parts_->channel = 0;
  parts_->last = {};
  std::fill(parts_->left_out.begin(), parts_->left_out.end(), 0);
  parts_->clipped_run = parts_->lost_frames = 0;
  parts_->frame_is_lost = true;
  parts_->unusable = BlindReason::none;
  for (SignalValidation& validation : parts_->validations) validation.reset();
  parts_->detector->reset();
}

const Detector& detector_of(const ChatterMonitor& monitor) {
  return *monitor.parts_->detector;
}

std::string_view to_string(Kind kind) {
  return name_in(kind_names, kind);
}
std::string_view to_string(Entropy entropy) {
  return name_in(entropy_names, entropy);
}
std::string_view to_string(State state) {
  return name_in(state_names, state);
}
std::string_view to_string(BlindReason reason) {
  return name_in(reason_names, reason);
}
std::string_view to_string(SynchronousChatter kind) {
  return name_in(synchronous_names, kind);
}
std::string_view to_string(Test test) {
  return name_in(test_names, test);
}
std::string_view to_string(Quantity quantity) {
  return words_for(quantity).name;
}
std::string_view to_string(Fault fault) {
  return name_in(names_of_faults, fault);
}

}  // namespace robomill::monitor
