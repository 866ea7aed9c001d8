// The default detector as its user has it, on cuts that are known to the last term.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/monitor.hpp"
#include "testing/monitor/decisions.hpp"
#include "testing/monitor/signal.hpp"

namespace order_detector_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::decisions_of;
using monitor::testing::first_alarm_s;
using monitor::testing::options_for;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

constexpr double turn = 2.0 * std::numbers::pi;

/// A second channel with pulses: of a tenth of a turn, or as long as their gaps.
std::vector<float> with_pulses(const SyntheticCut& cut, int pulses, double low, double high) {
  const std::vector<float> x = vibration(cut);
  std::vector<float> out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double turns = cut.rotation_hz * static_cast<double>(i) / cut.sample_rate_hz;
    out.push_back(x[i]);
    out.push_back(static_cast<float>(std::fmod(turns * pulses, 1.0) < (pulses > 1 ? 0.5 : 0.1) ? high : low));
  }
  return out;
}

TEST(OrderDetector, TheScoreExceedsTheThresholdExactlyInChatter) {
  for (const double hint_off : {0.0, 0.03, -1.0}) {
    for (const double chatter_hz : {0.0, 683.0}) {
      const SyntheticCut cut{.channels = 2, .chatter_hz = chatter_hz, .ends_s = 2.5, .seconds = 3.0};
      int chatter = 0;
      for (const Decision& d : decisions_of(options_for(cut, hint_off), vibration(cut))) {
        EXPECT_EQ(d.score > d.threshold, d.state == State::chatter) << d.time_s;
        EXPECT_EQ(d.state == State::blind, d.reason != BlindReason::none) << d.time_s;
        if (d.state == State::chatter) {
          EXPECT_GT(d.chatter_frequency_hz, 0.0) << d.time_s;
          EXPECT_GT(d.chatter_frequency_std_hz, 0.0) << d.time_s;
          ++chatter;
        }
        if (hint_off > -1.0) {
          EXPECT_GT(d.spindle_speed_rad_per_s, 0.0) << d.time_s;
          EXPECT_NE(d.reason, BlindReason::speed_unknown) << d.time_s;
        }
      }
      EXPECT_EQ(chatter > 0, chatter_hz > 0.0) << hint_off;
    }
  }
}

TEST(OrderDetector, CorrectsAHintThatIsATenthOff) {
  Random random(1);
  for (const double hint_off : {-0.1, -0.06, 0.04, 0.1}) {
    for (int run = 0; run < 3; ++run) {
      SyntheticCut cut{.rotation_hz = random.uniform(62.0, 200.0), .teeth = 2 + run, .seconds = 2.0};
      cut.seed = static_cast<std::uint64_t>(run) + 1;
      for (const Decision& d : decisions_of(options_for(cut, hint_off), vibration(cut))) {
        EXPECT_NE(d.state, State::chatter) << cut.rotation_hz << " " << hint_off << " " << d.time_s;
        if (d.time_s < 0.7) continue;
        EXPECT_NEAR(d.spindle_speed_rad_per_s / (turn * cut.rotation_hz), 1.0, 2e-3) << hint_off << " " << d.time_s;
        EXPECT_LT(d.spindle_speed_std_rad_per_s, 0.01 * d.spindle_speed_rad_per_s);
        EXPECT_FALSE(d.faults & speed_unknown) << d.time_s;
      }
    }
  }
}

TEST(OrderDetector, IsBlindWhereNeitherAHintNorACombGivesTheSpeed) {
  const SyntheticCut nothing{.seconds = 3.0};
  Random random(2);
  std::vector<float> air(static_cast<std::size_t>(nothing.seconds * nothing.sample_rate_hz));
  for (float& x : air) x = static_cast<float>(random.normal());
  MonitorOptions options = options_for(nothing);
  for (const Decision& d : decisions_of(options, air)) EXPECT_EQ(d.state, State::stable) << d.time_s;
  options.spindle_speed_rad_per_s = 0.0;
  for (const Decision& d : decisions_of(options, air)) {
    EXPECT_EQ(d.reason, d.time_s < 0.99 ? BlindReason::none : BlindReason::speed_unknown) << d.time_s;
  }
  // A hint ends it at once, and its loss begins it anew.
  ChatterMonitor monitor(options);
  const auto listen = [&] { return monitor.push(air); };
  EXPECT_EQ(listen().reason, BlindReason::speed_unknown);
  monitor.set_spindle_speed(500.0);
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::none);
  monitor.set_spindle_speed(0.0);
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::none);
  EXPECT_EQ(listen().reason, BlindReason::speed_unknown);
  monitor.reset();
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::none);
}

TEST(OrderDetector, FindsTheCombOfACutWithoutAHint) {
  const SyntheticCut cut{.rotation_hz = 71.0, .chatter_hz = 660.0, .seconds = 3.5};
  MonitorOptions options = options_for(cut);
  options.spindle_speed_rad_per_s = 0.0;
  const std::vector<Decision> decisions = decisions_of(options, vibration(cut));
  for (const Decision& d : decisions) EXPECT_NE(d.state, State::blind) << d.time_s;
  EXPECT_GT(first_alarm_s(decisions), 2.0);
  EXPECT_LT(first_alarm_s(decisions), 2.5);
}

TEST(OrderDetector, PulsesDetectNoLaterAndAlarmNoMore) {
  struct Wheel {
    int pulses;
    double rate_hz, rotation_hz, low, high;
  };
  for (const Wheel& wheel : {Wheel{1, 10240.0, 80.0, 0.0, 5.0}, Wheel{1, 10240.0, 80.0, 24.0, 0.0},
                             Wheel{60, 20480.0, 80.0, 0.0, 5.0}, Wheel{60, 20480.0, 80.0, 1.0, -1.0},
                             Wheel{1024, 81920.0, 33.0, 0.0, 5.0}, Wheel{1024, 81920.0, 33.0, 5.0, 0.0}}) {
    for (const double chatter_hz : {0.0, 683.0}) {
      SyntheticCut cut{.sample_rate_hz = wheel.rate_hz, .rotation_hz = wheel.rotation_hz, .chatter_hz = chatter_hz};
      cut.starts_s = 0.8;
      cut.seconds = 1.3;
      const double without = first_alarm_s(decisions_of(options_for(cut, 0.02), vibration(cut)));
      EXPECT_EQ(without > cut.starts_s, chatter_hz > 0.0) << wheel.pulses;
      const std::vector<float> both = with_pulses(cut, wheel.pulses, wheel.low, wheel.high);
      cut.channels = 2;
      for (const double hint_off : {0.02, -1.0}) {
        if (hint_off == -1.0 && wheel.high < wheel.low) continue;
        MonitorOptions options = options_for(cut, hint_off);
        options.tachometer_channel = 1;
        options.pulses_per_revolution = wheel.pulses;
        const std::vector<Decision> decisions = decisions_of(options, both);
        // To a hop; three where the pulses are all there is.
        EXPECT_LE(first_alarm_s(decisions), without + (hint_off > -1.0 ? 0.026 : 0.076))
            << wheel.pulses << " " << hint_off;
        EXPECT_EQ(first_alarm_s(decisions) > cut.starts_s, chatter_hz > 0.0) << wheel.pulses << " " << hint_off;
        for (const Decision& d : decisions) {
          if (d.time_s < 0.6) continue;
          EXPECT_NEAR(d.spindle_speed_rad_per_s / (turn * cut.rotation_hz), 1.0, 2e-3) << wheel.pulses << d.time_s;
          EXPECT_FALSE(d.faults) << wheel.pulses << " " << d.time_s;
          EXPECT_EQ(d.channel, 0);
        }
      }
    }
  }
}

// The hint is 8 % off, and the pulses stop: what was known stays.
TEST(OrderDetector, LivesOnWithoutPulses) {
  SyntheticCut cut{.chatter_hz = 683.0, .seconds = 3.0};
  std::vector<float> both = with_pulses(cut, 1, 0.0, 5.0);
  for (std::size_t i = both.size() / 2; i < both.size(); ++i) {
    if (i % 2 == 1) both[i] = 0.0F;
  }
  cut.channels = 2;
  MonitorOptions options = options_for(cut, 0.08);
  options.tachometer_channel = 1;
  const std::vector<Decision> decisions = decisions_of(options, both);
  EXPECT_GT(first_alarm_s(decisions), 2.0);
  EXPECT_LT(first_alarm_s(decisions), 2.4);
  for (const Decision& d : decisions) {
    if (d.time_s < 0.6) continue;
    EXPECT_NEAR(d.spindle_speed_rad_per_s / (turn * 80.0), 1.0, 2e-3) << d.time_s;
  }
}

TEST(OrderDetector, AnOffsetIsNoVibration) {
  const SyntheticCut cut{.chatter_hz = 683.0, .seconds = 3.0};
  const std::vector<float> x = vibration(cut);
  std::vector<float> lifted = x;
  for (float& sample : lifted) sample += 20.0F;
  const double there = first_alarm_s(decisions_of(options_for(cut), x));
  EXPECT_GT(there, 2.0);
  EXPECT_NEAR(first_alarm_s(decisions_of(options_for(cut), lifted)), there, 0.026);
}

}  // namespace order_detector_test
