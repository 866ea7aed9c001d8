#include "robomill/report/monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/report/json.hpp"
#include "robomill/report/monitor_recorder.hpp"
#include "robomill/report/monitor_sample.hpp"
#include "robomill/report/report.hpp"
#include "testing/support.hpp"

namespace robomill::report {
namespace {

using nlohmann::json;

monitor::MonitorOptions one_channel() {
  monitor::MonitorOptions options;
  options.sample_rate_hz = 10240.0;
  return options;
}

std::vector<float> tone(double frequency_hz, double seconds, double rate_hz) {
  std::vector<float> out(static_cast<std::size_t>(seconds * rate_hz));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / rate_hz));
  }
  return out;
}

TEST(MonitorRecorder, TheSpectrogramPeaksWhereTheToneIsAndWhenItIs) {
  MonitorRecorder recorder(one_channel(), {"a"}, "g");
  recorder.add(std::vector<float>(10240, 0.0F));
  recorder.add(tone(1000.0, 1.0, 10240.0));
  const MonitorRun run = recorder.run();
  Eigen::Index row = 0, column = 0;
  EXPECT_EQ(run.spectrogram.level_db.maxCoeff(&row, &column), 0.0);
  EXPECT_NEAR(run.spectrogram.frequency_hz[row], 1000.0, 10.0);
  EXPECT_GT(run.spectrogram.begin_s + static_cast<double>(column) * run.spectrogram.step_s, 0.99);
  EXPECT_EQ(run.spectrogram.level_db.leftCols(run.spectrogram.level_db.cols() / 3).maxCoeff(), -120.0);
  run.validate();
}

TEST(MonitorRecorder, LongRecordingsTakeNoMoreThanShortOnes) {
  MonitorRecorder recorder(one_channel(), {"a"}, "");
  const std::vector<float> second = tone(440.0, 1.0, 10240.0);
  monitor::Decision decision;
  for (int i = 0; i < 200; ++i) {
    recorder.add(second);
    for (int k = 0; k < 40; ++k) {
      decision.time_s += 0.025;
      decision.score = i;
      recorder.add(decision, 1e-4);
    }
  }
  const MonitorRun run = recorder.run();
  EXPECT_LE(run.channels[0].wave.low.size(), 3000);
  EXPECT_LE(run.score.low.size(), 1500);
  EXPECT_LE(run.spectrogram.level_db.cols(), 600);
  EXPECT_NEAR(static_cast<double>(run.channels[0].wave.low.size()) * run.wave_run_s, 200.0, run.wave_run_s);
  EXPECT_NEAR(static_cast<double>(run.spectrogram.level_db.cols()) * run.spectrogram.step_s, 200.0,
              run.spectrogram.step_s);
  EXPECT_NEAR(run.channels[0].wave.high.minCoeff(), 1.0, 1e-2);
  EXPECT_EQ(run.score.high[run.score.high.size() - 1], 199.0);
  EXPECT_EQ(run.decisions, 8000U);
  EXPECT_NEAR(run.compute_mean_s, 1e-4, 1e-12);
}

TEST(MonitorRecorder, KeepsWhatIsNoNumberOut) {
  MonitorRecorder recorder(one_channel(), {"a"}, "");
  std::vector<float> samples = tone(440.0, 0.5, 10240.0);
  samples[7] = std::numeric_limits<float>::quiet_NaN();
  samples[99] = std::numeric_limits<float>::infinity();
  recorder.add(samples);
  monitor::Decision decision;
  decision.score = std::numeric_limits<double>::infinity();
  recorder.add(decision, 0.0);
  EXPECT_NO_THROW(recorder.run().validate());
}

TEST(MonitorRecorder, StatesFollowEachOtherWithoutGaps) {
  const MonitorRun run = sample_monitor();
  ASSERT_GE(run.stays.size(), 4U);
  EXPECT_EQ(run.stays.front().from_s, 0.0);
  for (std::size_t i = 1; i < run.stays.size(); ++i) {
    EXPECT_EQ(run.stays[i].from_s, run.stays[i - 1].to_s);
    EXPECT_NE(run.stays[i].state, run.stays[i - 1].state);
  }
}

TEST(MonitorRecorder, RejectsNamesThatDoNotFit) {
  EXPECT_THROW(MonitorRecorder(one_channel(), {"a", "b"}, ""), InvalidInput);
  EXPECT_THROW(MonitorRecorder(one_channel(), {}, ""), InvalidInput);
}

TEST(MonitorReport, NumbersAreTheStructsInShopUnits) {
  const MonitorRun run = sample_monitor();
  const json data = json::parse(monitor_json(run).dump());
  EXPECT_EQ(data["channels"].size(), 2U);
  EXPECT_EQ(data["wave_time_s"].size(), data["channels"][1]["wave"].size());
  EXPECT_EQ(data["decisions"]["time_s"].size(), data["decisions"]["score"].size());
  EXPECT_NEAR(data["decisions"]["spindle_speed_rpm"][0].get<double>(), 3000.0, 0.01);
  EXPECT_EQ(data["spectrogram"]["level_db"].size(), data["spectrogram"]["frequency_hz"].size());
  EXPECT_EQ(data["events"][1]["mode"], 8);
  EXPECT_TRUE(data["events"][0]["mode"].is_null());
  EXPECT_TRUE(data["events"][0]["chatter_frequency_hz"].is_null());
  EXPECT_NEAR(data["events"][1]["suggested_spindle_speed_rpm"].get<double>(), 3416.0, 0.01);
}

TEST(MonitorReport, RejectsWhatDoesNotFit) {
  const auto rejected = [](auto&& spoil) {
    MonitorRun run = sample_monitor();
    spoil(run);
    return test::rejection([&] { run.validate(); });
  };
  EXPECT_NE(rejected([](MonitorRun& r) { r.channels.clear(); }).find("channels"), std::string::npos);
  EXPECT_NE(rejected([](MonitorRun& r) { r.channels[1].wave.low.resize(3); }).find("channels[1].wave"),
            std::string::npos);
  EXPECT_NE(rejected([](MonitorRun& r) { r.threshold.low[0] = missing; }).find("threshold.low"), std::string::npos);
  EXPECT_NE(rejected([](MonitorRun& r) { r.spectrogram.frequency_hz[3] = 0.0; }).find("spectrogram.frequency_hz"),
            std::string::npos);
}

}  // namespace
}  // namespace robomill::report
