#include "robomill/monitor/sensor_agreement.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robomill/monitor/explanation.hpp"
#include "robomill/monitor/machine.hpp"
#include "testing/allocations.hpp"
#include "testing/monitor/decisions.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace sensor_agreement_test {

using monitor::testing::decisions_of;
using monitor::testing::first_alarm_s;
using monitor::testing::options_for;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

/// Sensors with one channel each, of unlike noise.
struct Sensors {
  std::vector<SyntheticCut> cuts;
  std::vector<double> gains;  ///< empty: 1
};

std::vector<float> joined(const Sensors& sensors) {
  std::vector<std::vector<float>> each;
  for (std::size_t s = 0; s < sensors.cuts.size(); ++s) {
    SyntheticCut cut = sensors.cuts[s];
    cut.seed += 10 * s;
    each.push_back(vibration(cut));
    for (float& x : each.back()) x *= sensors.gains.empty() ? 1.0F : static_cast<float>(sensors.gains[s]);
  }
  std::vector<float> out;
  for (std::size_t i = 0; i < each.front().size(); ++i) {
    for (const std::vector<float>& one : each) out.push_back(one[i]);
  }
  return out;
}

MonitorOptions options_of(const Sensors& sensors) {
  MonitorOptions options = options_for(sensors.cuts.front());
  options.channels = static_cast<int>(sensors.cuts.size());
  for (int s = 0; s < options.channels; ++s) options.sensors.push_back(s);
  return options;
}

std::vector<Decision> decisions(const Sensors& sensors) {
  return decisions_of(options_of(sensors), joined(sensors));
}

const SyntheticCut calm = {}, chatters = {.chatter_hz = 683.0};
/// As chatters, at another line beside the orders: a tone of that sensor alone.
const SyntheticCut elsewhere = {.chatter_hz = 1015.0};
const SyntheticCut silent = {.teeth = 0, .noise = 0.0};

bool same(const Decision& a, const Decision& b) {
  return a.state == b.state && a.score == b.score && a.chatter_frequency_hz == b.chatter_frequency_hz &&
         a.spindle_speed_rad_per_s == b.spindle_speed_rad_per_s && a.faults == b.faults && a.reason == b.reason;
}

TEST(SensorAgreement, AlarmsWhereMoreThanHalfDetectChatterAtOneLine) {
  const double alone_s = first_alarm_s(decisions_of(options_for(chatters), vibration(chatters)));
  ASSERT_GT(alone_s, 2.0);
  EXPECT_NEAR(first_alarm_s(decisions({{chatters, chatters}, {}})), alone_s, 0.06);
  EXPECT_NEAR(first_alarm_s(decisions({{chatters, chatters, calm}, {}})), alone_s, 0.06);
  EXPECT_EQ(first_alarm_s(decisions({{chatters, calm}, {}})), -1.0);
  EXPECT_EQ(first_alarm_s(decisions({{chatters, calm, calm}, {}})), -1.0);
  EXPECT_EQ(first_alarm_s(decisions({{chatters, elsewhere, calm}, {}})), -1.0);
  EXPECT_EQ(first_alarm_s(decisions({{chatters, elsewhere}, {}})), -1.0);
  // A tone of one sensor, however loud, hides nothing.
  SyntheticCut tone = elsewhere;
  tone.chatter = 5.0;
  EXPECT_NEAR(first_alarm_s(decisions({{tone, chatters, chatters}, {}})), alone_s, 0.06);
}

// … and holds no alarm, if it was there before or comes while the others chatter.
TEST(SensorAgreement, AnAlarmEndsWithTheSensorsThatHoldIt) {
  SyntheticCut ends = chatters, later = elsewhere;
  ends.ends_s = later.starts_s = 3.0;
  for (const SyntheticCut& tone : {elsewhere, later}) {
    const std::vector<Decision> all = decisions({{ends, tone, ends}, {}});
    EXPECT_GT(first_alarm_s(all), 2.0);
    EXPECT_NE(all.back().state, State::chatter);
  }
}

// A sideband of chatter by the rotation is the same line.
TEST(SensorAgreement, LinesDifferByMultiplesOfRotation) {
  SyntheticCut sideband = chatters;
  sideband.chatter_hz += 3.0 * chatters.rotation_hz;
  EXPECT_GT(first_alarm_s(decisions({{chatters, sideband}, {}})), 2.0);
}

TEST(SensorAgreement, AsManyMustAgreeAsAreAskedFor) {
  for (const auto& [agreeing, alarm] : {std::pair{1, true}, std::pair{2, true}, std::pair{3, false}}) {
    const Sensors sensors = {{chatters, calm, chatters}, {}};
    MonitorOptions options = options_of(sensors);
    options.agreeing_sensors = agreeing;
    EXPECT_EQ(first_alarm_s(decisions_of(options, joined(sensors))) > 0.0, alarm) << agreeing;
  }
}

// No channel's unit counts: a current in A beside an acceleration in m/s².
TEST(SensorAgreement, UnitsDoNotCount) {
  const std::vector<Decision> one = decisions({{chatters, chatters}, {}});
  const std::vector<Decision> other = decisions({{chatters, chatters}, {1.0, 1.0 / 65536.0}});
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_TRUE(same(one[i], other[i])) << one[i].time_s;
}

TEST(SensorAgreement, TheOrderOfSensorsDoesNotCount) {
  Sensors sensors = {{chatters, calm, chatters}, {}};
  const std::vector<float> samples = joined(sensors);
  MonitorOptions options = options_of(sensors);
  const std::vector<Decision> one = decisions_of(options, samples);
  options.sensors = {1, 2, 0};
  const std::vector<Decision> other = decisions_of(options, samples);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].state, other[i].state) << one[i].time_s;
    if (one[i].state != State::chatter) continue;
    EXPECT_EQ(one[i].chatter_frequency_hz, other[i].chatter_frequency_hz);
    EXPECT_EQ(one[i].channel, other[i].channel);
  }
}

TEST(SensorAgreement, OneSensorOfAllChannelsIsNone) {
  SyntheticCut cut = chatters;
  cut.channels = 2;
  MonitorOptions options = options_for(cut);
  const std::vector<Decision> without = decisions_of(options, vibration(cut));
  options.sensors = {0, 0};
  const std::vector<Decision> with = decisions_of(options, vibration(cut));
  for (std::size_t i = 0; i < with.size(); ++i) {
    ASSERT_TRUE(same(with[i], without[i]));
    EXPECT_EQ(with[i].why.sensor, 0);
  }
}

// A cable that came off, and a sensor that never sees the cut, do not keep the others from an alarm.
TEST(SensorAgreement, ASensorThatShowsNothingHasNoVote) {
  const double both_s = first_alarm_s(decisions({{chatters, chatters}, {}}));
  EXPECT_NEAR(first_alarm_s(decisions({{chatters, chatters, silent}, {1.0, 1.0, 0.0}})), both_s, 0.06);
  EXPECT_GT(first_alarm_s(decisions({{chatters, silent}, {1.0, 0.0}})), 2.0);
  SyntheticCut noise = silent;
  noise.noise = 0.1;
  noise.rotation_hz = 1e-3;
  EXPECT_GT(first_alarm_s(decisions({{chatters, noise}, {}})), 2.0);
}

TEST(SensorAgreement, NamesChannelAndSensor) {
  SyntheticCut two = chatters;
  two.channels = 2;
  const std::vector<float> pairs = vibration(two);
  const std::vector<float> other = vibration(calm), third = vibration(chatters);
  std::vector<float> samples;
  for (std::size_t i = 0; i < other.size(); ++i)
    samples.insert(samples.end(), {other[i], pairs[2 * i], pairs[2 * i + 1], third[i]});
  MonitorOptions options = options_for(chatters);
  options.channels = 4;
  options.sensors = {0, 1, 1, 2};
  const std::vector<Decision> all = decisions_of(options, samples);
  ASSERT_EQ(all.back().state, State::chatter);
  EXPECT_NEAR(all.back().chatter_frequency_hz, 683.0, 1.0);
  EXPECT_TRUE(all.back().channel == 1 || all.back().channel == 3) << all.back().channel;
  EXPECT_EQ(all.back().why.sensor, all.back().channel == 1 ? 2 : 3);
  const Condition last = all.back().why.condition.at(static_cast<std::size_t>(all.back().why.conditions - 1));
  EXPECT_EQ(last.quantity, Quantity::agreement);
  EXPECT_TRUE(last.holds());
  EXPECT_NE(why_text(all.back().why, State::chatter).find("of sensor"), std::string::npos);
}

// Why there is no alarm although one sensor detects chatter.
TEST(SensorAgreement, ExplainsThatTheOthersDoNotAgree) {
  const Decision last = decisions({{chatters, calm, calm}, {}}).back();
  EXPECT_EQ(last.state, State::transition);
  EXPECT_LT(last.score, 1.0);
  EXPECT_EQ(last.why.sensor, 1);
  const std::string text = why_text(last.why, last.state);
  EXPECT_NE(text.find("agreement of the sensors"), std::string::npos) << text;
}

TEST(SensorAgreement, CountsPulsesForEverySensor) {
  SyntheticCut cut = chatters;
  const Sensors sensors = {{cut, cut}, {}};
  const std::vector<float> both = joined(sensors);
  std::vector<float> samples;
  for (std::size_t i = 0; i + 1 < both.size(); i += 2) {
    const double turns = cut.rotation_hz * static_cast<double>(i / 2) / cut.sample_rate_hz;
    samples.insert(samples.end(), {both[i], turns - std::floor(turns) < 0.1 ? 5.0F : 0.0F, both[i + 1]});
  }
  MonitorOptions options = options_of(sensors);
  options.spindle_speed_rad_per_s = 0.0;
  options.channels = 3;
  options.tachometer_channel = 1;
  options.sensors = {0, 0, 1};
  const std::vector<Decision> all = decisions_of(options, samples);
  EXPECT_GT(first_alarm_s(all), 2.0);
  EXPECT_NEAR(all.back().spindle_speed_rad_per_s, cut.rotation_hz * units::revolution, 1.0);
}

TEST(SensorAgreement, StandsStillAndLearnsAsOne) {
  const Sensors sensors = {{calm, calm}, {}};
  ChatterMonitor monitor(options_of(sensors));
  const std::vector<float> samples = joined(sensors);
  EXPECT_EQ(monitor.push(std::span(samples).first(2 * 256)).reason, BlindReason::learning);
  monitor.set_spindle_speed(0.0);
  EXPECT_EQ(monitor.push(std::span(samples).subspan(2 * 256, 2 * 256)).reason, BlindReason::standstill);
  monitor.reset();
  EXPECT_EQ(monitor.push(std::span(samples).first(2 * 256)).reason, BlindReason::standstill);
}

TEST(SensorAgreement, RejectsWhatItCannotDo) {
  const auto field = [](auto change) {
    MonitorOptions options = {.sample_rate_hz = 1e4, .channels = 3, .sensors = {0, 0, 1}};
    change(options);
    return test::field_of([&] { options.validate(); });
  };
  EXPECT_EQ(field([](MonitorOptions&) {}), "accepted");
  EXPECT_EQ(field([](MonitorOptions& o) { o.sensors = {0, 1}; }), "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) { o.sensors = {0, 0, 2}; }), "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) { o.sensors = {0, -1, 1}; }), "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) { o.sensors = {0, 0, 8}; }), "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) { o.sensors = {0, 0, std::numeric_limits<int>::max()}; }), "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) {
              o.sensors = {0, 1, 0};
              o.tachometer_channel = 0;
            }),
            "accepted");
  EXPECT_EQ(field([](MonitorOptions& o) {
              o.sensors = {0, 1, 1};
              o.tachometer_channel = 0;
            }),
            "sensors");
  EXPECT_EQ(field([](MonitorOptions& o) { o.agreeing_sensors = 3; }), "agreeing_sensors");
  EXPECT_EQ(field([](MonitorOptions& o) {
              o.kind = Kind::energy_entropy;
              o.threshold = 1.0;
            }),
            "sensors");
}

// Each sensor has a map of its own: a tone that one of them always shows is no chatter there.
TEST(SensorAgreement, LearnsAMachineBySensor) {
  SyntheticCut still = calm;
  still.chatter_hz = 683.0;
  still.starts_s = -10.0;
  still.chatter = 0.3;
  MonitorOptions options = options_of({{still, calm}, {}});
  options.agreeing_sensors = 2;
  const std::vector<CalmRecording> recordings = {{.name = "calm", .samples = joined({{still, calm}, {1.0, 1e-3}})}};
  const Machine machine = learn_machine(recordings, options);
  ASSERT_EQ(machine.sensors(), 2U);
  EXPECT_NO_THROW(machine.validate());
  EXPECT_EQ(machine.channels, 1);
  EXPECT_EQ(machine.others.front().channels, 1);
  EXPECT_NEAR(machine.others.front().quietest_energy * 1e6, machine.quietest_energy, 0.5 * machine.quietest_energy);
  const std::vector<float> weak = joined({{chatters, chatters}, {0.3, 3e-4}});
  EXPECT_GT(first_alarm_s(decisions_of(options, weak)), 2.0);
  options.machine = std::make_shared<const Machine>(machine);
  EXPECT_NO_THROW(options.validate());
  EXPECT_EQ(first_alarm_s(decisions_of(options, weak)), -1.0);
  options.sensors = {0, 0};
  options.agreeing_sensors = 0;
  EXPECT_EQ(test::field_of([&] { options.validate(); }), "machine");
}

TEST(SensorAgreement, AllocatesNothingInAHop) {
  for (const double rotation_hz : {80.0, 20.0, 6.0}) {
    SyntheticCut cut = chatters;
    cut.rotation_hz = rotation_hz;
    const Sensors sensors = {{cut, cut, calm}, {}};
    ChatterMonitor monitor(options_of(sensors));
    const std::vector<float> samples = joined(sensors);
    EXPECT_EQ(test::allocations([&] { monitor.push(samples); }), 0U) << rotation_hz;
  }
}

}  // namespace sensor_agreement_test
}  // namespace robomill::monitor
