#include "robomill/report/monitor_sample.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/report/monitor_recorder.hpp"

namespace robomill::report {

MonitorRun sample_monitor() {
  constexpr double rate_hz = 5120.0, seconds = 4.0, onset_s = 1.5, end_s = 3.0;
  monitor::MonitorOptions options;
  options.sample_rate_hz = rate_hz;
  options.channels = 2;
  MonitorRecorder recorder(options, {"ax_m_per_s2", "ay_m_per_s2"}, "m/s²");
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
  recorder.add({.time_s = 1.75, .state = monitor::State::transition, .score = 8.0, .threshold = 12.0});
  recorder.add({.time_s = 1.8,
                .state = monitor::State::chatter,
                .score = 20.0,
                .threshold = 12.0,
                .chatter_frequency_hz = 683.2,
                .chatter_frequency_std_hz = 0.6,
                .mode = {8},
                .suggested_spindle_speed_rad_per_s = 3416.0 * std::numbers::pi / 30.0});
  recorder.add({.time_s = 3.05, .state = monitor::State::stable, .score = 3.0, .threshold = 12.0});
  MonitorRun run = recorder.run();
  run.facts = {{"Recording", "cut.wav, 4 s at 5 120 Hz"}, {"Detector", "comb-cusum, 0.1 false alarms an hour"}};
  run.notes = {"A sample, not a recording."};
  return run;
}

CalibrationRun sample_calibration() {
  CalibrationRun run;
  run.facts = {{"Recordings", "480 holes, half to set, half to verify"}, {"Threshold", "110"}};
  run.false_alarm_rate = 0.008;
  run.detection_rate = 0.93;
  RocCurve curve{.label = "set",
                 .false_alarm_rate = Eigen::VectorXd::LinSpaced(101, 0.0, 1.0),
                 .detection_rate = Eigen::VectorXd(101),
                 .threshold = Eigen::VectorXd::LinSpaced(101, 200.0, 20.0)};
  curve.detection_rate = curve.false_alarm_rate.array().pow(0.02);
  curve.detection_rate[0] = 0.0;
  run.curves = {curve, curve};
  run.curves[1].label = "verified";
  run.curves[1].detection_rate = curve.detection_rate.array().square();
  run.rows = {
      {.name = "hole-001.wav", .chatter = true, .verifies = true, .alarmed = true, .delay_s = 0.04, .lead_s = 0.11},
      {.name = "hole-002.wav", .chatter = false, .verifies = true, .alarmed = true},
      {.name = "hole-003.wav", .chatter = true, .alarmed = false}};
  return run;
}

}  // namespace robomill::report
