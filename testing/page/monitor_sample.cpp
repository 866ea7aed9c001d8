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
namespace {

/// Of the test of the ratio, at an amplitude of chatter.
monitor::Explanation sample_why(double grown, int hops) {
  monitor::Explanation why{.test = monitor::Test::ratio, .hops = hops, .enough_hops = 6, .speed_belief = 0.41F};
  why.ask(monitor::Quantity::asynchronous_ratio, grown * grown, 0.2);
  why.ask(monitor::Quantity::family_above_quiet, 20.0 * grown, 1.0);
  why.ask(monitor::Quantity::order_change, 0.001, 0.005, true);
  why.ask(monitor::Quantity::entered, 0.9, 0.4);
  return why;
}

}  // namespace

std::string sample_monitor(const std::string& text) {
  const auto named = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  using monitor::State;
  constexpr double rate_hz = 5120.0, seconds = 6.0, lost_from_s = 5.0, lost_to_s = 5.4;
  monitor::MonitorOptions options;
  options.sample_rate_hz = rate_hz;
  options.channels = 2;
  options.teeth = 4;
  live::Recorder recorder(options, {named("ax_m_per_s2"), "ay_m_per_s2"}, named("m/s²"));
  Random random(7);
  const std::size_t hop = options.hop_samples();
  monitor::Decision decision;
  double phase = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(rate_hz * seconds); ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    const double onset_s = t < 3.2 ? 1.5 : 3.4;
    const bool growing = (t > 1.5 && t < 3.0) || (t > 3.4 && t < 4.0);
    const double grown = growing ? std::min(3.0, 0.01 * std::exp(15.0 * (t - onset_s))) : 0.0;
    const double chatter_hz = t < 3.2 ? 683.0 : 690.0 + 10.0 * (t - onset_s);
    const double turn = 2.0 * std::numbers::pi * t;
    phase += 2.0 * std::numbers::pi * chatter_hz / rate_hz;
    const std::array<float, 2> frame = {static_cast<float>(std::sin(200.0 * turn) + 0.4 * std::sin(400.0 * turn) +
                                                           grown * std::sin(phase) + 0.05 * random.normal()),
                                        static_cast<float>(0.6 * std::sin(200.0 * turn + 1.0) +
                                                           0.7 * grown * std::cos(phase) + 0.05 * random.normal())};
    const bool lost = t >= lost_from_s && t < lost_to_s;
    if (lost) {
      recorder.skip(1);
    } else {
      recorder.add(frame);
    }
    if (lost || (i + 1) % hop != 0) continue;
    const State before = decision.state;
    decision.hop = (i + 1) / hop;
    decision.time_s = static_cast<double>(i + 1) / rate_hz;
    decision.threshold = 12.0;
    decision.energy_entropy = 40.0 + 30.0 * grown;
    const bool known = t > 0.6 && t < 4.5;
    decision.spindle_speed_rad_per_s = known ? (3000.0 - 2.0 * t) * std::numbers::pi / 30.0 : 0.0;
    decision.spindle_speed_std_rad_per_s = known ? (0.5 + 4.0 * std::exp(-3.0 * (t - 0.6))) * std::numbers::pi / 30 : 0;
    decision.state = t < 0.6       ? State::blind
                     : grown > 0.6 ? State::chatter
                     : grown > 0.2 ? State::transition
                                   : State::stable;
    decision.reason = decision.state == State::blind ? monitor::BlindReason::speed_unknown : monitor::BlindReason::none;
    decision.score = decision.state == State::chatter ? 12.0 + 4.0 * grown : 2.0 + 15.0 * grown;
    decision.chatter_frequency_hz = decision.state == State::chatter ? chatter_hz + 0.2 * random.normal() : 0.0;
    decision.chatter_frequency_std_hz = decision.state == State::chatter ? 0.6 : 0.0;
    decision.why = decision.state == State::blind ? monitor::Explanation()
                                                  : sample_why(grown, decision.state == State::chatter ? 6 : 2);
    recorder.add(decision, 180e-6);
    if (decision.state == before) continue;
    monitor::MonitorEvent event;
    event.time_s = decision.time_s;
    event.decision = decision;
    event.explained = true;
    if (decision.state == State::chatter) {
      event.mode = {8};
      event.suggested_spindle_speed_rad_per_s = 3416.0 * std::numbers::pi / 30.0;
    }
    recorder.add(event);
  }
  monitor::MonitorEvent lost;
  lost.kind = monitor::MonitorEvent::Kind::stream;
  lost.time_s = lost_to_s;
  lost.decision = decision;
  lost.what = "lost-blocks";
  lost.message = named("2 blocks of the stream never came");
  recorder.add(lost);
  live::RecordedRun run = recorder.run();
  run.facts = {{named("Recording"), named("cut.wav, 6 s at 5 120 Hz")},
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
