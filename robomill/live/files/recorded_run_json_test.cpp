#include "robomill/live/files/recorded_run_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "robomill/live/recorder.hpp"

namespace robomill::live {
namespace recorded_run_json_test {

TEST(RecordedRunJson, HoldsWhatWasRecorded) {
  constexpr double rate_hz = 10240.0;
  monitor::MonitorOptions options;
  options.sample_rate_hz = rate_hz;
  Recorder recorder(options, {"ax"}, "g");
  std::vector<float> samples(4 * 10240);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = static_cast<float>(std::sin(2.0 * std::numbers::pi * 440.0 * static_cast<double>(i) / rate_hz));
  }
  recorder.add(samples);
  monitor::Decision decision;
  decision.spindle_speed_rad_per_s = 100.0 * std::numbers::pi;
  decision.spindle_speed_std_rad_per_s = 0.1 * std::numbers::pi;
  decision.score = HUGE_VAL;
  recorder.add(decision, 2e-4);
  decision.state = monitor::State::chatter;
  decision.chatter_frequency_hz = 440.0;
  decision.chatter_frequency_std_hz = 0.5;
  decision.why = {.test = monitor::Test::ratio, .hops = 6, .enough_hops = 6};
  decision.why.ask(monitor::Quantity::asynchronous_ratio, 0.31, 0.2);
  decision.spindle_speed_rad_per_s = 0.0;
  decision.time_s = 1.0;
  recorder.add(decision, 2e-4);
  monitor::MonitorEvent folded;
  folded.decision = decision;
  folded.no_speed = monitor::NoSpeed::ambiguous_alias;
  folded.line_hz = {440.0, 560.0};
  recorder.add(folded);
  decision.state = monitor::State::blind;
  decision.reason = monitor::BlindReason::speed_unknown;
  decision.time_s = 1.5;
  recorder.add(decision, 2e-4);
  decision.time_s = 4.0;
  recorder.add(decision, 2e-4);
  recorder.skip(10240);
  monitor::MonitorEvent event;
  event.mode = {8};
  recorder.add(event);
  RecordedRun run = recorder.run();
  run.facts = {{"Detector", "comb-cusum"}};
  const auto json = nlohmann::json::parse(recorded_run_json(run));
  EXPECT_EQ(json["facts"][0]["label"], "Detector");
  EXPECT_EQ(json["unit"], "g");
  const auto& wave = json["channels"][0]["wave"];
  ASSERT_EQ(wave["low"].size(), wave["high"].size());
  EXPECT_NEAR(static_cast<double>(wave["low"].size()) * json["wave_run_s"].get<double>(), 5.0, 0.01);
  EXPECT_NEAR(wave["low"][7].get<double>(), -wave["high"][7].get<double>(), 0.1);
  EXPECT_TRUE(wave["low"].back().is_null());
  const auto& decisions = json["decisions"];
  EXPECT_NEAR(decisions["spindle_speed_rpm"]["high"][0].get<double>(), 3000.0, 1e-9);
  EXPECT_NEAR(decisions["spindle_speed_std_rpm"]["high"][0].get<double>(), 3.0, 1e-9);
  EXPECT_TRUE(decisions["spindle_speed_rpm"]["low"].back().is_null());
  EXPECT_TRUE(decisions["score"]["low"][0].is_null());
  EXPECT_TRUE(decisions["chatter_frequency_hz"]["low"][0].is_null());
  EXPECT_EQ(decisions["chatter_frequency_hz"]["low"].size(), decisions["score"]["low"].size());
  EXPECT_EQ(json["decisions"]["run_s"].get<double>(), static_cast<double>(options.hop_samples()) / rate_hz);
  EXPECT_EQ(json["decision_count"], 4);
  EXPECT_NEAR(json["compute_max_us"].get<double>(), 200.0, 1e-9);
  EXPECT_EQ(json["spectrogram"]["level_db"].size(), json["spectrogram"]["frequency_hz"].size());
  const auto& spectrogram = json["spectrogram"];
  EXPECT_NEAR(spectrogram["max_frequency_hz"].get<double>(), 660.0, 1e-9);
  EXPECT_NEAR(spectrogram["frequency_hz"].back().get<double>(), 660.0, 10.0);
  EXPECT_TRUE(spectrogram["level_db"][0].back().is_null());
  EXPECT_EQ(json["stays"][0]["state"], "stable");
  EXPECT_TRUE(json["stays"][0]["reason"].is_null());
  EXPECT_EQ(json["stays"][2]["state"], "blind");
  EXPECT_EQ(json["stays"][2]["reason"], "speed-unknown");
  EXPECT_EQ(json["stays"][3]["reason"], "gap");
  EXPECT_EQ(json["state_times"], nlohmann::json::parse(R"([{"state": "stable", "reason": null, "duration_s": 1.0},
                                      {"state": "chatter", "reason": null, "duration_s": 0.5},
                                      {"state": "blind", "reason": "speed-unknown", "duration_s": 2.5}])"));
  EXPECT_EQ(json["alarm_count"], 1);
  const auto& alarm = json["alarms"].at(0);
  EXPECT_EQ(alarm["count"], 1);
  EXPECT_EQ(alarm["from_s"], 1.0);
  EXPECT_EQ(alarm["chatter_s"], 0.5);
  EXPECT_EQ(alarm["chatter_frequency_std_hz"], 0.5);
  EXPECT_EQ(alarm["channel"], "ax");
  EXPECT_TRUE(alarm["mode"].is_null());
  EXPECT_TRUE(alarm["suggested_spindle_speed_rpm"].is_null());
  EXPECT_EQ(alarm["no_speed"], "ambiguous-alias");
  EXPECT_EQ(alarm["line_frequencies_hz"], (std::vector<double>{440.0, 560.0}));
  EXPECT_EQ(alarm["why"]["test"], "ratio");
  EXPECT_EQ(alarm["why"]["conditions"][0]["value"], 0.31);
  EXPECT_TRUE(json["teeth"].is_null());
  EXPECT_EQ(json["events"][1]["mode"], 8);
  EXPECT_TRUE(json["events"][1]["chatter_frequency_hz"].is_null());
}

TEST(RecordedRunJson, NoSignalIsNull) {
  monitor::MonitorOptions options;
  options.sample_rate_hz = 10240.0;
  const auto json = nlohmann::json::parse(recorded_run_json(Recorder(options, {"ax"}, "").run()));
  EXPECT_TRUE(json["spectrogram"].is_null());
  EXPECT_TRUE(json["compute_mean_us"].is_null());
  EXPECT_TRUE(json["decisions"]["score"]["low"].empty());
}

}  // namespace recorded_run_json_test
}  // namespace robomill::live
