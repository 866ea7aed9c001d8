#include "robomill/live/recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::live {
namespace recorder_test {

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

TEST(Recorder, TheSpectrogramPeaksWhereTheToneIsAndWhenItIs) {
  Recorder recorder(one_channel(), {"a"}, "g");
  recorder.add(std::vector<float>(10240, 0.0F));
  recorder.add(tone(1000.0, 1.0, 10240.0));
  const RecordedRun run = recorder.run();
  Eigen::Index row = 0, column = 0;
  EXPECT_EQ(run.spectrogram.level_db.maxCoeff(&row, &column), 0.0);
  EXPECT_NEAR(run.spectrogram.frequency_hz[row], 1000.0, 10.0);
  EXPECT_GT(run.spectrogram.begin_s + static_cast<double>(column) * run.spectrogram.step_s, 0.99);
  EXPECT_EQ(run.spectrogram.level_db.leftCols(run.spectrogram.level_db.cols() / 3).maxCoeff(), -120.0);
}

TEST(Recorder, LongRecordingsTakeNoMoreThanShortOnes) {
  Recorder recorder(one_channel(), {"a"}, "");
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
  const RecordedRun run = recorder.run();
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

TEST(Recorder, ListsSomeThousandChangesOfState) {
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  for (int i = 0; i < 5000; ++i) {
    decision.time_s = 0.025 * i;
    decision.state = i % 2 == 0 ? monitor::State::stable : monitor::State::chatter;
    recorder.add(decision, 1e-4);
  }
  const RecordedRun run = recorder.run();
  EXPECT_EQ(run.stays.size(), 2000U);
  EXPECT_EQ(run.stays.back().to_s, 0.025 * 2000);
  EXPECT_EQ(run.notes, std::vector<std::string>{"3000 more changes of state are not drawn."});
}

TEST(Recorder, KeepsWhatIsNoNumberOut) {
  Recorder recorder(one_channel(), {"a"}, "");
  std::vector<float> samples = tone(440.0, 0.5, 10240.0);
  samples[7] = std::numeric_limits<float>::quiet_NaN();
  samples[99] = std::numeric_limits<float>::infinity();
  recorder.add(samples);
  monitor::Decision decision;
  decision.score = std::numeric_limits<double>::infinity();
  recorder.add(decision, 0.0);
  const RecordedRun run = recorder.run();
  EXPECT_TRUE(run.channels[0].wave.low.allFinite());
  EXPECT_TRUE(run.channels[0].wave.high.allFinite());
  EXPECT_TRUE(run.spectrogram.level_db.allFinite());
  EXPECT_EQ(run.score.high[0], 0.0);
}

TEST(Recorder, StatesFollowEachOtherWithoutGaps) {
  using monitor::State;
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  for (const State state :
       {State::stable, State::stable, State::transition, State::chatter, State::chatter, State::stable}) {
    decision.time_s += 0.025;
    decision.state = state;
    recorder.add(decision, 0.0);
  }
  const std::vector<Stay> stays = recorder.run().stays;
  ASSERT_EQ(stays.size(), 4U);
  EXPECT_EQ(stays.front().from_s, 0.0);
  EXPECT_EQ(stays.back().to_s, decision.time_s);
  for (std::size_t i = 1; i < stays.size(); ++i) {
    EXPECT_EQ(stays[i].from_s, stays[i - 1].to_s);
    EXPECT_NE(stays[i].state, stays[i - 1].state);
  }
}

TEST(Recorder, RejectsNamesThatDoNotFit) {
  EXPECT_THROW(Recorder(one_channel(), {"a", "b"}, ""), InvalidInput);
  EXPECT_THROW(Recorder(one_channel(), {}, ""), InvalidInput);
}

}  // namespace recorder_test
}  // namespace robomill::live
