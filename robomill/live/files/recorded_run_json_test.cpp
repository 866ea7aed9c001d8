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
  decision.score = HUGE_VAL;
  recorder.add(decision, 2e-4);
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
  EXPECT_NEAR(static_cast<double>(wave["low"].size()) * json["wave_run_s"].get<double>(), 4.0, 0.01);
  EXPECT_NEAR(wave["low"][7].get<double>(), -wave["high"][7].get<double>(), 0.1);
  EXPECT_NEAR(json["decisions"]["spindle_speed_rpm"]["high"][0].get<double>(), 3000.0, 1e-9);
  EXPECT_EQ(json["decisions"]["run_s"].get<double>(), static_cast<double>(options.hop_samples()) / rate_hz);
  EXPECT_EQ(json["decision_count"], 1);
  EXPECT_NEAR(json["compute_max_us"].get<double>(), 200.0, 1e-9);
  EXPECT_EQ(json["spectrogram"]["level_db"].size(), json["spectrogram"]["frequency_hz"].size());
  EXPECT_EQ(json["stays"][0]["state"], "stable");
  EXPECT_EQ(json["events"][0]["mode"], 8);
  EXPECT_TRUE(json["events"][0]["chatter_frequency_hz"].is_null());
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
