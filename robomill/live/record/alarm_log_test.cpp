#include "robomill/live/record/alarm_log.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace robomill::live {
namespace alarm_log_test {

using monitor::State;

constexpr double hop_s = 0.025;

/// Decisions hop by hop.
struct Stream {
  AlarmLog log;
  monitor::Decision decision;
  void stable(double seconds) {
    pass(State::stable, seconds, [](double) { return 0.0; });
  }
  void chatter(double seconds, double frequency_hz) {
    pass(State::chatter, seconds, [=](double) { return frequency_hz; });
  }
  template <class Frequency>
  void pass(State state, double seconds, const Frequency& frequency_hz) {
    for (int i = 0; i < std::lround(seconds / hop_s); ++i) {
      decision.time_s += hop_s;
      decision.state = state;
      decision.chatter_frequency_hz = frequency_hz(i * hop_s);
      log.add(decision, {"x", "y"});
    }
  }
};

TEST(AlarmLog, JoinsAlarmsOfOneFrequency) {
  Stream stream;
  stream.decision.chatter_frequency_std_hz = 2.0;
  for (int i = 0; i < 8; ++i) {
    stream.stable(0.5);
    stream.chatter(0.25, 700.0 + i);
  }
  stream.decision.chatter_frequency_std_hz = 0.5;
  stream.decision.channel = 1;
  stream.stable(0.5);
  stream.chatter(0.25, 703.5);
  stream.stable(0.5);
  const std::vector<RecordedAlarm> alarms = stream.log.alarms();
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].count, 9U);
  EXPECT_EQ(stream.log.count(), 9U);
  EXPECT_NEAR(alarms[0].from_s, 0.525, 1e-9);
  EXPECT_NEAR(alarms[0].to_s, 9 * 0.75 + hop_s, 1e-9);
  EXPECT_NEAR(alarms[0].chatter_s, 9 * 0.25, 1e-9);
  EXPECT_EQ(alarms[0].low_frequency_hz, 700.0);
  EXPECT_EQ(alarms[0].high_frequency_hz, 707.0);
  EXPECT_EQ(alarms[0].chatter_frequency_hz, 703.5);
  EXPECT_EQ(alarms[0].chatter_frequency_std_hz, 0.5);
  EXPECT_EQ(alarms[0].channel, "y");
  EXPECT_EQ(stream.log.highest_hz(), 707.0);
}

TEST(AlarmLog, FollowsAFrequencyThatDrifts) {
  Stream stream;
  stream.pass(State::chatter, 5.0, [](double t) { return 600.0 + 60.0 * t; });
  stream.stable(1.0);
  stream.chatter(0.5, 900.0);
  ASSERT_EQ(stream.log.alarms().size(), 1U);
  EXPECT_EQ(stream.log.alarms()[0].count, 2U);
  EXPECT_NEAR(stream.log.alarms()[0].high_frequency_hz, 900.0, 1e-9);
  EXPECT_TRUE(std::isnan(stream.log.alarms()[0].chatter_frequency_std_hz));
}

TEST(AlarmLog, KeepsAlarmsApartByFrequencyAndByTime) {
  Stream stream;
  for (int i = 0; i < 3; ++i) {
    stream.chatter(0.25, 600.0);
    stream.stable(0.25);
    stream.chatter(0.25, 1200.0);
    stream.stable(0.25);
  }
  stream.stable(20.0);
  stream.chatter(0.25, 600.0);
  const std::vector<RecordedAlarm> alarms = stream.log.alarms();
  ASSERT_EQ(alarms.size(), 3U);
  EXPECT_EQ(alarms[0].count, 3U);
  EXPECT_EQ(alarms[1].count, 3U);
  EXPECT_EQ(alarms[1].low_frequency_hz, 1200.0);
  EXPECT_EQ(alarms[2].count, 1U);
  EXPECT_EQ(stream.log.count(), 7U);
}

TEST(AlarmLog, AMisreadFrequencyIsNoAlarmOfItsOwn) {
  Stream stream;
  stream.chatter(0.5, 742.0);
  stream.chatter(3 * hop_s, 286.0);
  stream.chatter(0.5, 742.0);
  ASSERT_EQ(stream.log.alarms().size(), 1U);
  EXPECT_EQ(stream.log.alarms()[0].low_frequency_hz, 742.0);
  EXPECT_NEAR(stream.log.alarms()[0].chatter_s, 1.0 + 2 * hop_s, 1e-9);
  stream.chatter(0.5, 286.0);  // a jump that lasts
  ASSERT_EQ(stream.log.alarms().size(), 2U);
  EXPECT_EQ(stream.log.count(), 1U);
}

TEST(AlarmLog, AnAlarmMayHaveNoFrequency) {
  Stream stream;
  stream.chatter(0.25, 0.0);
  EXPECT_TRUE(std::isnan(stream.log.alarms().at(0).low_frequency_hz));
  EXPECT_EQ(stream.log.highest_hz(), 0.0);
  stream.chatter(0.25, 500.0);
  ASSERT_EQ(stream.log.alarms().size(), 1U);
  EXPECT_EQ(stream.log.alarms()[0].low_frequency_hz, 500.0);
}

TEST(AlarmLog, TakesTheAdviceOnTheSurestFrequency) {
  Stream stream;
  stream.chatter(0.25, 700.0);
  monitor::MonitorEvent event;
  event.decision = stream.decision;
  event.decision.chatter_frequency_std_hz = 0.5;
  event.mode = {8};
  event.suggested_spindle_speed_rad_per_s = 350.0;
  stream.log.add(event);
  event.decision.chatter_frequency_std_hz = 3.0;
  event.mode = {2};
  stream.log.add(event);
  EXPECT_EQ(stream.log.alarms().at(0).mode.number, 8);
  EXPECT_EQ(stream.log.alarms()[0].suggested_spindle_speed_rad_per_s, 350.0);
  EXPECT_EQ(stream.log.alarms()[0].no_speed, monitor::NoSpeed::none);
}

TEST(AlarmLog, SaysWhyNothingIsAdvised) {
  Stream stream;
  stream.chatter(0.25, 661.0);
  monitor::MonitorEvent event;
  event.decision = stream.decision;
  event.decision.chatter_frequency_std_hz = 3.0;
  event.mode = {8};
  event.line_hz = {989.0};
  stream.log.add(event);
  EXPECT_EQ(stream.log.alarms().at(0).line_hz, event.line_hz);
  event.decision.chatter_frequency_std_hz = 0.5;
  event.mode = {};
  event.line_hz = {661.0, 989.0};
  event.no_speed = monitor::NoSpeed::ambiguous_alias;
  stream.log.add(event);
  const RecordedAlarm alarm = stream.log.alarms().at(0);
  EXPECT_FALSE(alarm.mode.known());
  EXPECT_EQ(alarm.line_hz, event.line_hz);
  EXPECT_EQ(alarm.no_speed, monitor::NoSpeed::ambiguous_alias);
}

TEST(AlarmLog, SaysWhyNoSpeedIsSuggested) {
  Stream stream;
  stream.chatter(0.25, 80.0);
  monitor::MonitorEvent event;
  event.decision = stream.decision;
  event.no_speed = monitor::NoSpeed::unclear;
  stream.log.add(event);
  EXPECT_EQ(stream.log.alarms().at(0).no_speed, monitor::NoSpeed::unclear);
  EXPECT_TRUE(std::isnan(stream.log.alarms()[0].suggested_spindle_speed_rad_per_s));
}

TEST(AlarmLog, EndsWhereNothingFollows) {
  Stream stream;
  stream.chatter(0.5, 700.0);
  stream.log.end(0.51);
  stream.decision.time_s = 5.0;
  stream.stable(1.0);
  EXPECT_NEAR(stream.log.alarms().at(0).to_s, 0.51, 1e-9);
  EXPECT_NEAR(stream.log.alarms()[0].chatter_s, 0.51 - hop_s, 1e-9);
}

TEST(AlarmLog, ListsAHundredRows) {
  Stream stream;
  for (int i = 0; i < 150; ++i) {
    stream.chatter(0.05, 100.0 * std::pow(1.2, i % 20));
    stream.stable(12.0);
  }
  EXPECT_EQ(stream.log.alarms().size(), 100U);
  EXPECT_EQ(stream.log.unlisted(), 50U);
  EXPECT_EQ(stream.log.count(), 150U);
}

}  // namespace alarm_log_test
}  // namespace robomill::live
