#include "testing/page/monitor_sample.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/live/files/recorded_run_json.hpp"
#include "robomill/live/recorder.hpp"
#include "robomill/monitor/files/calibration_json.hpp"

namespace robomill::page {

std::string sample_monitor(const std::string& text) {
  const auto named = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  constexpr double rate_hz = 5120.0, seconds = 4.0, onset_s = 1.5, end_s = 3.0;
  monitor::MonitorOptions options;
  options.sample_rate_hz = rate_hz;
  options.channels = 2;
  live::Recorder recorder(options, {named("ax_m_per_s2"), "ay_m_per_s2"}, named("m/s²"));
  Random random(7);
  const std::size_t hop = options.hop_samples();
  for (std::size_t i = 0; i < static_cast<std::size_t>(rate_hz * seconds); ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    const double grown = t > onset_s && t < end_s ? std::min(3.0, 0.01 * std::exp(15.0 * (t - onset_s))) : 0.0;
    const double turn = 2.0 * std::numbers::pi * t;
    const std::array<float, 2> frame = {
        static_cast<float>(std::sin(200.0 * turn) + 0.4 * std::sin(400.0 * turn) + grown * std::sin(683.0 * turn) +
                           0.05 * random.normal()),
        static_cast<float>(0.6 * std::sin(200.0 * turn + 1.0) + 0.7 * grown * std::cos(683.0 * turn) +
                           0.05 * random.normal())};
    recorder.add(frame);
    if ((i + 1) % hop != 0) continue;
    monitor::Decision decision;
    decision.hop = (i + 1) / hop;
    decision.time_s = static_cast<double>(i + 1) / rate_hz;
    decision.score = 2.0 + 20.0 * grown;
    decision.threshold = 12.0;
    decision.energy_entropy = 40.0 + 30.0 * grown;
    decision.spindle_speed_rad_per_s = 3000.0 * std::numbers::pi / 30.0;
    decision.state = grown > 0.6   ? monitor::State::chatter
                     : grown > 0.2 ? monitor::State::transition
                                   : monitor::State::stable;
    recorder.add(decision, 180e-6);
  }
  using monitor::State;
  const auto event = [](double time_s, State state, double score) {
    monitor::MonitorEvent out;
    out.time_s = time_s;
    out.decision = {.state = state, .score = score, .threshold = 12.0};
    return out;
  };
  recorder.add(event(1.75, State::transition, 8.0));
  monitor::MonitorEvent chatter = event(1.8, State::chatter, 20.0);
  chatter.decision.chatter_frequency_hz = 683.2;
  chatter.decision.chatter_frequency_std_hz = 0.6;
  chatter.mode = {8};
  chatter.suggested_spindle_speed_rad_per_s = 3416.0 * std::numbers::pi / 30.0;
  recorder.add(chatter);
  monitor::MonitorEvent lost = event(2.5, State::chatter, 20.0);
  lost.kind = monitor::MonitorEvent::Kind::stream;
  lost.what = "lost-blocks";
  lost.message = named("2 blocks of the stream never came");
  recorder.add(lost);
  recorder.add(event(3.05, State::stable, 3.0));
  live::RecordedRun run = recorder.run();
  run.facts = {{named("Recording"), named("cut.wav, 4 s at 5 120 Hz")},
               {"Detector", "comb-cusum, 0.1 false alarms an hour"}};
  if (!text.empty()) run.warnings = {text};
  run.notes = {named("A sample, not a recording.")};
  return live::recorded_run_json(run);
}

std::string sample_calibration(const std::string& name) {
  monitor::Calibration out;
  out.options.kind = monitor::Kind::energy_entropy;
  out.options.threshold = 110.0;
  for (int i = 0; i <= 100; ++i) {
    const double false_alarms = 0.01 * i;
    const double found = i == 0 ? 0.0 : std::pow(false_alarms, 0.02);
    const double threshold = 200.0 - 1.8 * i;
    out.setting.roc.push_back({.threshold = threshold, .false_alarm_rate = false_alarms, .detection_rate = found});
    out.verifying.roc.push_back(
        {.threshold = threshold, .false_alarm_rate = false_alarms, .detection_rate = found * found});
  }
  out.status = monitor::Calibration::Status::found;
  out.setting.stable = out.verifying.stable = 120;
  out.setting.chatter = out.verifying.chatter = 120;
  out.setting.chosen = {.threshold = 110.0, .false_alarm_rate = 0.008, .detection_rate = 0.95};
  out.verifying.chosen = {
      .threshold = 110.0, .false_alarm_rate = 0.008, .detection_rate = 0.93, .median_delay_s = 0.04};
  out.median_lead_s = 0.11;
  out.alarms = {{.name = name, .chatter = true, .verifying = true, .alarm_s = 1.04, .onset_s = 1.0, .lead_s = 0.11},
                {.name = "hole-002.wav", .verifying = true, .alarm_s = 0.5},
                {.name = "hole-003.wav", .chatter = true, .onset_s = 1.0}};
  return monitor::calibration_json(out);
}

}  // namespace robomill::page
