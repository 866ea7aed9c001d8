#include "robomill/live/recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
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
  EXPECT_NEAR(run.spectrogram.frequency_hz[row], 1000.0, 5.0);
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
  EXPECT_TRUE(std::isnan(run.score.high[0]));
}

TEST(Recorder, AnUnknownSpeedIsAbsent) {
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  for (int i = 1; i <= 20'000; ++i) {
    decision.time_s = 0.025 * i;
    const bool known = i % 2 == 0 && i < 10'000;
    decision.spindle_speed_rad_per_s = known ? 100.0 + 1e-4 * i : 0.0;
    decision.spindle_speed_std_rad_per_s = known && i > 5'000 ? 0.5 : 0.0;
    recorder.add(decision, 1e-4);
  }
  const RecordedRun run = recorder.run();
  const signal::Band& speed = run.spindle_speed_rad_per_s;
  for (Eigen::Index i = 0; i < speed.low.size(); ++i) {
    const double end_s = static_cast<double>(i + 1) * run.decision_run_s;
    if (end_s < 249.0) {
      EXPECT_GT(speed.low[i], 99.9);
    } else if (end_s > 253.0) {
      EXPECT_TRUE(std::isnan(speed.low[i]) && std::isnan(speed.high[i]));
    }
    EXPECT_TRUE(!(speed.high[i] > 101.0));
    if (end_s < 124.0) {
      EXPECT_TRUE(std::isnan(run.spindle_speed_std_rad_per_s.high[i]));
    } else if (end_s > 129.0 && end_s < 249.0) {
      EXPECT_EQ(run.spindle_speed_std_rad_per_s.high[i], 0.5);
    }
  }
}

TEST(Recorder, NothingIsKnownOfWhatWasLeftOut) {
  using monitor::State;
  Recorder recorder(one_channel(), {"a"}, "");
  const std::vector<float> hop = tone(440.0, 0.025, 10240.0);
  monitor::Decision decision;
  decision.score = 3.0;
  const auto listen = [&](int hops) {
    for (int i = 0; i < hops; ++i) {
      decision.time_s += 0.025;
      recorder.add(decision, 1e-4);
      recorder.add(hop);
    }
  };
  listen(40);
  constexpr double left_out_s = 1000.0;
  recorder.skip(static_cast<std::uint64_t>(left_out_s * 10240.0));
  decision.time_s += left_out_s;
  listen(40);
  const RecordedRun run = recorder.run();
  ASSERT_EQ(run.stays.size(), 3U);
  EXPECT_EQ(run.stays[1].state, State::blind);
  EXPECT_EQ(run.stays[1].reason, monitor::BlindReason::gap);
  EXPECT_NEAR(run.stays[1].to_s - run.stays[1].from_s, left_out_s, 0.026);
  ASSERT_EQ(run.state_times.size(), 2U);
  EXPECT_NEAR(run.state_times[0].duration_s, 2.0, 0.026);
  // Waves, decisions and spectrogram have the gap where the states have it.
  const auto gap = [](const auto& values) { return static_cast<double>(values.array().isNaN().count()); };
  EXPECT_NEAR(gap(run.channels[0].wave.low) * run.wave_run_s, left_out_s, 2.0 * run.wave_run_s);
  EXPECT_NEAR(gap(run.score.low) * run.decision_run_s, left_out_s, 2.0 * run.decision_run_s);
  EXPECT_NEAR(gap(run.spectrogram.level_db.row(0)) * run.spectrogram.step_s, left_out_s, 2.0 * run.spectrogram.step_s);
  const double end_s = run.stays.back().to_s;
  EXPECT_NEAR(static_cast<double>(run.score.low.size()) * run.decision_run_s, end_s, run.decision_run_s);
  EXPECT_NEAR(static_cast<double>(run.spectrogram.level_db.cols()) * run.spectrogram.step_s, end_s,
              run.spectrogram.step_s + 0.1);
}

TEST(Recorder, ABlindMonitorHasNoScore) {
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  decision.score = 7.0;
  decision.state = monitor::State::blind;
  decision.reason = monitor::BlindReason::speed_unknown;
  for (int i = 1; i < 20; ++i) {
    decision.time_s = 0.025 * i;
    recorder.add(decision, 1e-4);
  }
  const RecordedRun run = recorder.run();
  EXPECT_TRUE(run.score.low.array().isNaN().all());
  ASSERT_EQ(run.stays.size(), 1U);
  EXPECT_EQ(run.stays[0].reason, monitor::BlindReason::speed_unknown);
  EXPECT_EQ(run.stays[0].from_s, 0.0);
}

// However many alarms there are: events are listed up to a number.
TEST(Recorder, FollowsTheFrequencyOfChatter) {
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  for (int i = 1; i <= 8000; ++i) {
    decision.time_s = 0.025 * i;
    decision.state = i > 4000 ? monitor::State::chatter : monitor::State::stable;
    decision.chatter_frequency_hz = i > 4000 ? 680.0 + 5.0 * (i % 2) : 0.0;
    recorder.add(decision, 1e-4);
  }
  const RecordedRun run = recorder.run();
  const signal::Band& frequency_hz = run.chatter_frequency_hz;
  ASSERT_GT(frequency_hz.low.size(), 700);
  EXPECT_TRUE(std::isnan(frequency_hz.low[frequency_hz.low.size() / 2 - 3]));
  EXPECT_EQ(frequency_hz.low[frequency_hz.low.size() - 2], 680.0);
  EXPECT_EQ(frequency_hz.high[frequency_hz.high.size() - 2], 685.0);
}

// A score and the state it belongs to are drawn over one axis of time.
TEST(Recorder, ScoresStandWhereTheirStatesBegin) {
  Recorder recorder(one_channel(), {"a"}, "");
  monitor::Decision decision;
  for (int i = 1; i <= 100; ++i) {
    decision.time_s = 0.025 * i;
    decision.state = i >= 60 ? monitor::State::chatter : monitor::State::stable;
    decision.score = i >= 60 ? 20.0 : 1.0;
    recorder.add(decision, 1e-4);
  }
  const RecordedRun run = recorder.run();
  for (Eigen::Index i = 1; i < run.score.low.size(); ++i) {
    EXPECT_EQ(run.score.low[i] > 10.0, static_cast<double>(i) * run.decision_run_s > run.stays[1].from_s - 1e-9);
  }
}

TEST(Recorder, TheSpectrogramEndsWithWhatIsWorthDrawing) {
  monitor::MonitorOptions options;
  options.sample_rate_hz = 51'200.0;
  options.teeth = 4;
  Recorder quiet(options, {"a"}, ""), chattering(options, {"a"}, "");
  const std::vector<float> samples = tone(1000.0, 2.0, options.sample_rate_hz);
  for (Recorder* recorder : {&quiet, &chattering}) recorder->add(samples);
  const Spectrogram low = quiet.run().spectrogram;
  EXPECT_LT(low.max_frequency_hz, 1050.0);
  EXPECT_GT(low.max_frequency_hz, 1000.0);
  EXPECT_LE(low.frequency_hz[low.frequency_hz.size() - 1], low.max_frequency_hz + 10.0);
  EXPECT_NEAR(low.frequency_hz[1] - low.frequency_hz[0], 10.0, 1e-9);

  monitor::Decision decision;
  decision.state = monitor::State::chatter;
  decision.chatter_frequency_hz = 3000.0;
  decision.spindle_speed_rad_per_s = 100.0;
  chattering.add(decision, 0.0);
  EXPECT_EQ(chattering.run().spectrogram.max_frequency_hz, 4500.0);
  decision.chatter_frequency_hz = 20'000.0;
  for (int i = 0; i < 5; ++i) chattering.add(decision, 0.0);
  const Spectrogram all = chattering.run().spectrogram;
  EXPECT_EQ(all.max_frequency_hz, 25'600.0);
  EXPECT_LE(all.frequency_hz.size(), 257);
  EXPECT_NEAR(all.frequency_hz[all.frequency_hz.size() - 1], 25'600.0, 200.0);
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
