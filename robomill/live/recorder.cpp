#include "robomill/live/recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/live/record/alarm_log.hpp"
#include "robomill/live/record/spectrogram_store.hpp"
#include "robomill/live/record/state_log.hpp"

namespace robomill::live {
namespace {

constexpr std::size_t wave_runs = 3000, decision_runs = 1500;
constexpr std::size_t most_channels = 4;  ///< whose spectrogram is kept
constexpr std::size_t most_events = 400;
constexpr double two_windows = 2.0;  ///< of the detector: the spectrogram's, whose lines are half as far apart

enum Curve : std::size_t { score, threshold, energy_entropy, frequency, speed, speed_std, curves };

double finite_or_none(double value) {
  return std::isfinite(value) ? value : NAN;
}

double positive_or_none(double value) {
  return value > 0.0 && std::isfinite(value) ? value : NAN;
}

}  // namespace

struct Recorder::Parts {
  Parts(const monitor::MonitorOptions& given, std::vector<std::string> names, std::string of)
      : options(given),
        channels(std::move(names)),
        unit(std::move(of)),
        waves(channels.size(), wave_runs),
        decisions(curves, decision_runs),
        frame(channels.size()) {
    const auto window = static_cast<std::size_t>(two_windows * static_cast<double>(given.window_samples()));
    const std::size_t kept = std::min(channels.size(), most_channels);
    for (std::size_t i = 0; i < kept; ++i) spectrograms.emplace_back(given.sample_rate_hz, window);
  }

  monitor::MonitorOptions options;
  std::vector<std::string> channels;
  std::string unit;
  signal::Bands waves, decisions;
  std::vector<double> frame;
  std::vector<SpectrogramStore> spectrograms;
  std::uint64_t frames = 0;  ///< that came or were left out
  std::uint64_t placed = 0;  ///< decisions and times without one
  std::size_t count = 0, unreported = 0;
  double compute_s = 0.0, compute_max_s = 0.0;
  int loudest = 0;  ///< channel of the last chatter
  StateLog states;
  AlarmLog alarms;
  std::vector<std::string> events;

  /// Leaves the curves of decisions empty up to this time.
  void place(double time_s);
  /// Where the spectrogram ends: with what stands out of the noise, and so that chatter and the cut are well within.
  [[nodiscard]] double max_frequency_hz(const SpectrogramStore& shown) const;
};

void Recorder::Parts::place(double time_s) {
  const double at = time_s * options.sample_rate_hz / static_cast<double>(options.hop_samples());
  if (!(at > 0.0 && at < 1e15)) return;
  const auto index = static_cast<std::uint64_t>(std::llround(at));
  if (index <= placed) return;
  decisions.skip(index - placed);
  placed = index;
}

double Recorder::Parts::max_frequency_hz(const SpectrogramStore& shown) const {
  double fastest_hz = 0.0;  // rotation
  for (const double rad_per_s : decisions.band(speed).high) {
    fastest_hz = std::fmax(fastest_hz, rad_per_s / (2.0 * std::numbers::pi));
  }
  const double cut_hz = fastest_hz * std::max(options.teeth, 1);
  const double chatter_hz = alarms.highest_hz();
  const double least_hz = std::max(1.5 * chatter_hz, 2.0 * cut_hz);
  double out = shown.energy_limit_hz();
  if (chatter_hz > 0.0) out = std::min(out, 4.0 * std::max(chatter_hz, cut_hz));
  return std::min(std::max(out, least_hz), 0.5 * options.sample_rate_hz);
}

Recorder::Recorder(const monitor::MonitorOptions& options, std::vector<std::string> channels, std::string unit) {
  options.validate();
  if (channels.size() != static_cast<std::size_t>(options.channels)) {
    throw InvalidInput("channels", static_cast<double>(channels.size()), "", "must be one name a channel");
  }
  parts_ = std::make_unique<Parts>(options, std::move(channels), std::move(unit));
}
Recorder::~Recorder() = default;
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;

void Recorder::add(std::span<const float> samples) {
  Parts& parts = *parts_;
  const std::size_t channels = parts.channels.size();
  for (std::size_t at = 0; at + channels <= samples.size(); at += channels) {
    for (std::size_t c = 0; c < channels; ++c) {
      const auto sample = static_cast<double>(samples[at + c]);
      parts.frame[c] = finite_or_none(sample);
      if (c < parts.spectrograms.size()) parts.spectrograms[c].add(sample);
    }
    parts.waves.add(parts.frame);
    ++parts.frames;
  }
}

void Recorder::skip(std::uint64_t frames, monitor::BlindReason reason) {
  Parts& parts = *parts_;
  const double from_s = static_cast<double>(parts.frames) / parts.options.sample_rate_hz;
  parts.waves.skip(frames);
  for (SpectrogramStore& each : parts.spectrograms) each.skip(frames);
  parts.frames += frames;
  parts.states.leave_out(from_s, reason);
  parts.alarms.end(from_s);
}

void Recorder::silent(double seconds) {
  Parts& parts = *parts_;
  const double at_s = static_cast<double>(parts.frames) / parts.options.sample_rate_hz;
  parts.states.silent(at_s, seconds);
  parts.alarms.end(at_s);
}

void Recorder::add(const monitor::Decision& decision, double compute_s) {
  Parts& parts = *parts_;
  const bool blind = decision.state == monitor::State::blind;
  std::array<double, curves> values = {};
  values[score] = blind ? NAN : finite_or_none(decision.score);
  values[threshold] = finite_or_none(decision.threshold);
  values[energy_entropy] = finite_or_none(decision.energy_entropy);
  const bool chatters = decision.state == monitor::State::chatter;
  values[frequency] = chatters ? positive_or_none(decision.chatter_frequency_hz) : NAN;
  values[speed] = positive_or_none(decision.spindle_speed_rad_per_s);
  const bool known = !std::isnan(values[speed]);
  values[speed_std] = known ? positive_or_none(decision.spindle_speed_std_rad_per_s) : NAN;
  parts.place(decision.time_s);
  parts.decisions.add(values);
  ++parts.placed;
  ++parts.count;
  parts.compute_s += compute_s;
  parts.compute_max_s = std::max(parts.compute_max_s, compute_s);
  if (chatters) parts.loudest = decision.channel;
  parts.states.add(decision.time_s, decision.state, decision.reason);
  parts.alarms.add(decision, parts.channels);
}

void Recorder::add(const monitor::MonitorEvent& event) {
  parts_->alarms.add(event);
  if (parts_->events.size() < most_events) {
    parts_->events.push_back(monitor::event_line(event));
  } else {
    ++parts_->unreported;
  }
}

RecordedRun Recorder::run() const {
  const Parts& parts = *parts_;
  RecordedRun out;
  out.unit = parts.unit;
  out.wave_run_s = static_cast<double>(parts.waves.length()) / parts.options.sample_rate_hz;
  for (std::size_t c = 0; c < parts.channels.size(); ++c) {
    out.channels.push_back({.name = parts.channels[c], .wave = parts.waves.band(c)});
  }
  out.decision_run_s =
      static_cast<double>(parts.decisions.length() * parts.options.hop_samples()) / parts.options.sample_rate_hz;
  out.score = parts.decisions.band(score);
  out.threshold = parts.decisions.band(threshold);
  out.energy_entropy = parts.decisions.band(energy_entropy);
  out.chatter_frequency_hz = parts.decisions.band(frequency);
  out.spindle_speed_rad_per_s = parts.decisions.band(speed);
  out.spindle_speed_std_rad_per_s = parts.decisions.band(speed_std);
  out.teeth = parts.options.teeth;
  out.stays = parts.states.stays();
  out.state_times = parts.states.times();
  out.alarm_count = parts.alarms.count();
  out.alarms = parts.alarms.alarms();
  out.events = parts.events;
  out.decisions = parts.count;
  if (parts.count > 0) {
    out.compute_mean_s = parts.compute_s / static_cast<double>(parts.count);
    out.compute_max_s = parts.compute_max_s;
  }
  const auto add_note = [&out](std::size_t count, const char* what) {
    if (count > 0) out.notes.push_back(std::to_string(count) + what);
  };
  add_note(parts.unreported, " more events are not listed.");
  add_note(parts.states.unlisted(), " more changes of state are not drawn.");
  add_note(parts.alarms.unlisted(), " more alarms are not listed.");

  const auto shown = std::min(static_cast<std::size_t>(std::max(parts.loudest, 0)), parts.spectrograms.size() - 1);
  const SpectrogramStore& store = parts.spectrograms[shown];
  out.spectrogram = store.part(parts.max_frequency_hz(store));
  out.spectrogram.channel = parts.channels[shown];
  return out;
}

}  // namespace robomill::live
