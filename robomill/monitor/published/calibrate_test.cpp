#include "robomill/monitor/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace calibrate_test {

constexpr double rate_hz = 10240.0;

/// 1.5 s of noise and four tooth-passing lines; chatter grows by e in 20 ms from `onset_s` on, from 1/100 to
/// `amplitude`.
Recording cut(std::uint64_t seed, double amplitude, double onset_s, double frequency_hz = 733.0) {
  Random random(seed);
  Recording out = {.name = "cut " + std::to_string(seed),
                   .chatter = amplitude > 0.0,
                   .samples = {},
                   .onset_s = amplitude > 0.0 ? onset_s : unknown_s};
  const double gain = random.uniform(0.8, 1.25), phase = random.uniform(0.0, 6.0);
  for (int m = 0; m < 15360; ++m) {
    const double t = m / rate_hz;
    double x = 0.3 * random.normal();
    for (int h = 1; h <= 4; ++h) x += 0.5 / h * std::sin(2.0 * std::numbers::pi * 100.0 * h * t + phase * h);
    if (t >= onset_s) {
      x += amplitude * std::min(1.0, 0.01 * std::exp((t - onset_s) / 0.02)) *
           std::sin(2.0 * std::numbers::pi * frequency_hz * t);
    }
    out.samples.push_back(static_cast<float>(gain * x));
  }
  return out;
}

std::vector<Recording> mixed(int each, double amplitude = 3.0) {
  std::vector<Recording> out;
  for (int k = 0; k < each; ++k) {
    out.push_back(cut(static_cast<std::uint64_t>(k), 0.0, 0.0));
    out.push_back(cut(static_cast<std::uint64_t>(1000 + k), amplitude, 0.6 + 0.02 * k));
  }
  return out;
}

TEST(Calibrate, SeparatesChatterThatIsLoudInBothForms) {
  const std::vector<Recording> recordings = mixed(12);
  for (const Entropy entropy : {Entropy::normalised, Entropy::energy}) {
    const Calibration c = calibrate(recordings, {.sample_rate_hz = rate_hz, .entropy = entropy});
    EXPECT_EQ(c.options.kind, Kind::energy_entropy);
    EXPECT_EQ(c.setting.stable, 6);
    EXPECT_EQ(c.verifying.chatter, 6);
    EXPECT_EQ(c.setting.chosen.false_alarm_rate, 0.0);
    EXPECT_EQ(c.setting.chosen.detection_rate, 1.0);
    EXPECT_GE(c.verifying.chosen.detection_rate, 0.8);
    // Loud chatter adds energy; its one line takes the bands' evenness away.
    EXPECT_EQ(c.options.alarm_below, entropy == Entropy::normalised);
    // Growth takes 92 ms, a window and its centre 75 ms more.
    EXPECT_GT(c.verifying.chosen.median_delay_s, 0.0);
    EXPECT_LT(c.verifying.chosen.median_delay_s, 0.2);
  }
}

TEST(Calibrate, SaysThatItFoundAThreshold) {
  const Calibration c = calibrate(mixed(6), {.sample_rate_hz = rate_hz});
  EXPECT_EQ(c.status, Calibration::Status::found);
  EXPECT_EQ(reason(c), "");
}

// Recordings with a label and nothing that the entropy could tell by.
TEST(Calibrate, SaysWhereNoThresholdDetects) {
  std::vector<Recording> recordings = mixed(6, 0.0);
  for (std::size_t r = 1; r < recordings.size(); r += 2) recordings[r] = recordings[r - 1];
  for (std::size_t r = 1; r < recordings.size(); r += 2) recordings[r].chatter = true;
  const Calibration c = calibrate(recordings, {.sample_rate_hz = rate_hz}, {.false_alarm_rate = 0.0});
  EXPECT_NE(c.status, Calibration::Status::found);
  EXPECT_FALSE(reason(c).empty());
  EXPECT_TRUE(std::isfinite(c.options.threshold));  // what was reached
  EXPECT_EQ(c.verifying.chatter, 3);
}

// The half that sets the threshold has loud chatter, the other one none that is louder than the stable cuts.
TEST(Calibrate, SaysWhereTheOtherHalfDoesNotVerify) {
  std::vector<Recording> recordings = mixed(6);
  const MonitorOptions o = {.sample_rate_hz = rate_hz};
  const Calibration first = calibrate(recordings, o);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    if (first.alarms[r].verifying && recordings[r].chatter) recordings[r].samples = recordings[0].samples;
  }
  const Calibration c = calibrate(recordings, o);
  EXPECT_EQ(c.setting.chosen.detection_rate, 1.0);
  EXPECT_EQ(c.status, Calibration::Status::not_verified);
  EXPECT_NE(reason(c).find("0 of 3 recordings with chatter found in the verifying half"), std::string::npos)
      << reason(c);
}

// The stable recordings of the verifying half are as loud as those with chatter.
TEST(Calibrate, SaysWhereAnAlarmTellsNothing) {
  std::vector<Recording> recordings = mixed(6);
  const MonitorOptions o = {.sample_rate_hz = rate_hz};
  const Calibration first = calibrate(recordings, o);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    if (first.alarms[r].verifying && !recordings[r].chatter) recordings[r].samples = recordings[1].samples;
  }
  const Calibration c = calibrate(recordings, o);
  EXPECT_EQ(c.status, Calibration::Status::no_better_than_chance);
  EXPECT_NE(reason(c).find("3 of 3 stable ones raise a false alarm"), std::string::npos) << reason(c);
}

// A quiet cut between the lines: chatter at many lines evens the bands out, and the normalised entropy rises.
TEST(Calibrate, FindsTheDirection) {
  std::vector<Recording> recordings;
  for (std::uint64_t k = 0; k < 8; ++k) {
    Recording stable = {.name = "stable", .chatter = false, .samples = std::vector<float>(10240)};
    Recording even = {.name = "even", .chatter = true, .samples = std::vector<float>(10240)};
    Random random(k);
    for (std::size_t m = 0; m < 10240; ++m) {
      const double line = std::sin(0.25 * static_cast<double>(m));
      stable.samples[m] = static_cast<float>(line + 0.01 * random.normal());
      even.samples[m] = static_cast<float>(line + (m > 5000 ? 1.0 : 0.01) * random.normal());
    }
    recordings.push_back(stable);
    recordings.push_back(even);
  }
  const Calibration c = calibrate(recordings, {.sample_rate_hz = rate_hz, .entropy = Entropy::normalised});
  EXPECT_FALSE(c.options.alarm_below);
  EXPECT_EQ(c.verifying.chosen.detection_rate, 1.0);
  EXPECT_TRUE(std::isnan(c.median_lead_s));  // no onset known
}

TEST(Calibrate, RocRunsFromNoneToAll) {
  const Calibration c = calibrate(mixed(10, 0.6), {.sample_rate_hz = rate_hz});
  for (const CalibratedHalf* half : {&c.setting, &c.verifying}) {
    const std::vector<RocPoint>& roc = half->roc;
    EXPECT_EQ(roc.front().false_alarm_rate, 0.0);
    EXPECT_EQ(roc.front().detection_rate, 0.0);
    EXPECT_EQ(roc.back().false_alarm_rate, 1.0);
    for (std::size_t k = 1; k < roc.size(); ++k) {
      EXPECT_GE(roc[k].false_alarm_rate, roc[k - 1].false_alarm_rate);
      EXPECT_TRUE(c.options.alarm_below ? roc[k].threshold > roc[k - 1].threshold
                                        : roc[k].threshold < roc[k - 1].threshold);
    }
  }
}

// Who allows more false alarms gets every alarm at least as early.
TEST(Calibrate, KeepsTheWantedShareOfFalseAlarmsAndAlarmsEarlierForMore) {
  const std::vector<Recording> recordings = mixed(12, 0.8);
  const MonitorOptions o = {.sample_rate_hz = rate_hz};
  std::vector<Alarm> before;
  int earlier = 0;
  for (const double wanted : {0.0, 0.2, 0.5}) {
    const Calibration c = calibrate(recordings, o, {.false_alarm_rate = wanted});
    EXPECT_FALSE(c.options.alarm_below);
    EXPECT_LE(c.setting.chosen.false_alarm_rate, wanted);
    EXPECT_GT(c.setting.chosen.false_alarm_rate, wanted - 1.0 / 6.0 - 1e-9);  // six set it
    for (std::size_t r = 0; r < before.size(); ++r) {
      if (std::isnan(before[r].alarm_s)) continue;
      EXPECT_LE(c.alarms[r].alarm_s, before[r].alarm_s);
      earlier += c.alarms[r].alarm_s < before[r].alarm_s ? 1 : 0;
    }
    before = c.alarms;
  }
  EXPECT_GT(earlier, 0);
}

TEST(Calibrate, ReportsTheLeadOverTheSpectrogram) {
  const std::vector<Recording> recordings = mixed(12);
  const Calibration c = calibrate(recordings, {.sample_rate_hz = rate_hz});
  ASSERT_EQ(c.alarms.size(), recordings.size());
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Alarm& alarm = c.alarms[r];
    EXPECT_EQ(alarm.name, recordings[r].name);
    if (!alarm.chatter) {
      EXPECT_TRUE(std::isnan(alarm.visible_s));
      continue;
    }
    EXPECT_NEAR(alarm.line_hz, 733.0, 10.1);
    EXPECT_GT(alarm.visible_s, alarm.onset_s);
    EXPECT_LT(alarm.visible_s, alarm.onset_s + 0.25);  // three columns: 100 ms
    if (std::isfinite(alarm.alarm_s)) {
      EXPECT_DOUBLE_EQ(alarm.lead_s, alarm.visible_s - alarm.alarm_s);
    }
  }
  EXPECT_TRUE(std::isfinite(c.median_lead_s));
}

TEST(Calibrate, IsTheSameAtAnyThreadCountAndSplitsBySeed) {
  const std::vector<Recording> recordings = mixed(8);
  const MonitorOptions o = {.sample_rate_hz = rate_hz};
  const int threads = thread_count();
  set_thread_count(1);
  const Calibration one = calibrate(recordings, o);
  set_thread_count(3);
  const Calibration three = calibrate(recordings, o);
  set_thread_count(threads);
  EXPECT_EQ(one.options.threshold, three.options.threshold);
  std::set<std::vector<bool>> splits;
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    std::vector<bool> verifying;
    for (const Alarm& alarm : calibrate(recordings, o, {.seed = seed}).alarms) verifying.push_back(alarm.verifying);
    splits.insert(verifying);
  }
  EXPECT_GT(splits.size(), 1U);
}

// The same signal in both channels: the sum over the channels doubles.
TEST(Calibrate, SumsOverChannels) {
  const std::vector<Recording> one = mixed(4);
  std::vector<Recording> two = one;
  for (Recording& recording : two) {
    std::vector<float> doubled;
    for (const float x : recording.samples) doubled.insert(doubled.end(), {x, x});
    recording.samples = doubled;
  }
  const double single = calibrate(one, {.sample_rate_hz = rate_hz}).options.threshold;
  EXPECT_DOUBLE_EQ(calibrate(two, {.sample_rate_hz = rate_hz, .channels = 2}).options.threshold, 2.0 * single);
  // A tachometer's channel is not processed.
  EXPECT_DOUBLE_EQ(
      calibrate(two, {.sample_rate_hz = rate_hz, .channels = 2, .tachometer_channel = 1}).options.threshold, single);
}

TEST(Calibrate, RejectsWhatCannotCalibrate) {
  const MonitorOptions o = {.sample_rate_hz = rate_hz};
  std::vector<Recording> stable, chatter;
  for (std::uint64_t k = 0; k < 3; ++k) {
    stable.push_back(cut(k, 0.0, 0.0));
    chatter.push_back(cut(k, 1.0, 0.5));
  }
  const auto says = [&](const std::vector<Recording>& recordings) {
    return test::rejection([&] { static_cast<void>(calibrate(recordings, o)); });
  };
  EXPECT_NE(says(stable).find("hold no chatter"), std::string::npos);
  EXPECT_NE(says(chatter).find("hold no stable cut"), std::string::npos);
  EXPECT_NE(says({stable[0], stable[1], chatter[0]}).find("at least two"), std::string::npos);
  EXPECT_NE(says({stable[0], chatter[0], chatter[1]}).find("at least two"), std::string::npos);
  std::vector<Recording> bad = {stable[0], stable[1], chatter[0], chatter[1]};
  bad[1].samples[77] = std::nanf("");
  EXPECT_NE(says(bad).find("finite"), std::string::npos);
  bad[1].samples.resize(1000);
  EXPECT_NE(says(bad).find("three windows"), std::string::npos);
  EXPECT_EQ(test::field_of([&] { static_cast<void>(calibrate(bad, o, {.false_alarm_rate = 1.0})); }),
            "false_alarm_rate");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(calibrate(bad, {}, {})); }), "sample_rate_hz");
}

}  // namespace calibrate_test
}  // namespace robomill::monitor
