// The default detector as its user has it, on cuts that are known to the last term.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
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

// At a speed that is given 11 % wrong tooth passing stands beside the orders: no alarm is held by it.
TEST(OrderDetector, AnAlarmEndsWithItsChatterWhereTheSpeedIsWrong) {
  for (const double off : {0.11, -0.11}) {
    const SyntheticCut cut{
        .rotation_hz = 75.08, .teeth = 4, .chatter_hz = 683.0, .chatter = 6.0, .ends_s = 4.0, .seconds = 8.0};
    const std::vector<Decision> decisions = decisions_of(options_for(cut, off), vibration(cut));
    EXPECT_GT(first_alarm_s(decisions), 2.0) << off;
    for (const Decision& d : decisions) EXPECT_FALSE(d.time_s > 4.8 && d.state == State::chatter) << d.time_s;
  }
}

TEST(OrderDetector, DetectsATonesGrowthOnceAndItsEnd) {
  for (const auto& [teeth, rotation, chatter] : {std::tuple{3, 80.0, 683.0}, std::tuple{2, 133.0, 1210.0}}) {
    const SyntheticCut cut{
        .rotation_hz = rotation, .teeth = teeth, .channels = 2, .chatter_hz = chatter, .ends_s = 3.2, .seconds = 5.0};
    const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
    // A tenth of the final amplitude at 2 + ln(100)/30 s.
    const double alarm = first_alarm_s(decisions);
    EXPECT_GT(alarm, 2.0);
    EXPECT_LT(alarm, 2.0 + std::log(100.0) / 30.0 + 0.2);
    int changes = 0;
    for (const Decision& d : decisions) {
      changes += d.changed && d.state == State::chatter ? 1 : 0;
      if (d.time_s > 2.6 && d.time_s < 3.15) {
        EXPECT_EQ(d.state, State::chatter);
        EXPECT_NEAR(d.chatter_frequency_hz, chatter, 1.0);
        EXPECT_NEAR(d.spindle_speed_rad_per_s, turn * rotation, 1e-3 * turn * rotation);
      }
      // 0.3 s of the window, 0.3 s until an alarm ends.
      if (d.time_s > 3.8) {
        EXPECT_EQ(d.state, State::stable) << d.time_s;
      }
    }
    EXPECT_EQ(changes, 1);
  }
}

TEST(OrderDetector, StaysQuietInAStableCut) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SyntheticCut cut{.rotation_hz = 60.0 + 17.0 * static_cast<double>(seed),
                           .noise = 0.05 * static_cast<double>(seed),
                           .seconds = 20.0,
                           .seed = seed};
    EXPECT_EQ(first_alarm_s(decisions_of(options_for(cut, 0.01 * static_cast<double>(seed)), vibration(cut))), -1.0)
        << seed;
  }
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
        if (d.time_s < 1.0) continue;
        EXPECT_NEAR(d.spindle_speed_rad_per_s / (turn * cut.rotation_hz), 1.0, 2e-3) << hint_off << " " << d.time_s;
        EXPECT_FALSE(d.faults & speed_unknown) << d.time_s;
      }
    }
  }
}

TEST(OrderDetector, IsBlindWhereNeitherAHintNorACombGivesTheSpeed) {
  const SyntheticCut nothing{.seconds = 4.0};
  Random random(2);
  std::vector<float> air(static_cast<std::size_t>(nothing.seconds * nothing.sample_rate_hz));
  for (float& x : air) x = static_cast<float>(random.normal());
  MonitorOptions options = options_for(nothing);
  for (const Decision& d : decisions_of(options, air)) {
    if (d.time_s > 2.99) {
      EXPECT_EQ(d.state, State::stable) << d.time_s;
    } else {
      EXPECT_EQ(d.reason, BlindReason::learning) << d.time_s;
    }
  }
  options.spindle_speed_rad_per_s = 0.0;
  for (const Decision& d : decisions_of(options, air)) {
    EXPECT_EQ(d.reason, d.time_s < 0.99 ? BlindReason::learning : BlindReason::speed_unknown) << d.time_s;
  }
  // A hint ends it at once, and its loss begins it anew.
  ChatterMonitor monitor(options);
  const auto listen = [&] { return monitor.push(air); };
  EXPECT_EQ(listen().reason, BlindReason::speed_unknown);
  monitor.set_spindle_speed(500.0);
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::none);
  monitor.set_spindle_speed(-1.0);
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::none);
  EXPECT_EQ(listen().reason, BlindReason::speed_unknown);
  monitor.reset();
  EXPECT_EQ(monitor.push(std::span(air).first(256)).reason, BlindReason::learning);
}

/// A spindle at rest for half a second, and then a cut at 9,000 rpm that chatters from 1 s on.
SyntheticCut cut_after_rest() {
  return {.rotation_hz = 150.0, .teeth = 2, .chatter_hz = 1268.0, .starts_s = 1.0, .seconds = 18.5};
}
std::vector<float> after_rest(const SyntheticCut& cut) {
  std::vector<float> x = vibration(cut);
  Random random(4);
  for (std::size_t i = 0; i < static_cast<std::size_t>(0.5 * cut.sample_rate_hz); ++i) {
    x[i] = static_cast<float>(0.05 * random.normal());
  }
  return x;
}

// What a stream says of a spindle that hardly turns, and then of one that cuts.
TEST(OrderDetector, AlarmsInTimeAfterAStandstill) {
  const SyntheticCut cut = cut_after_rest();
  const std::vector<float> x = after_rest(cut);
  for (const double rest_rpm : {0.05, 0.0, 29.0}) {
    MonitorOptions options = options_for(cut);
    options.spindle_speed_rad_per_s = 0.0;
    ChatterMonitor monitor(options);
    const std::size_t block = options.hop_samples();
    std::vector<Decision> decisions;
    for (std::size_t at = 0; at + block <= x.size(); at += block) {
      const bool rests = static_cast<double>(at) < 0.5 * cut.sample_rate_hz;
      monitor.set_spindle_speed((rests ? rest_rpm : 9000.0) * units::rpm);
      decisions.push_back(monitor.push(std::span(x).subspan(at, block)));
      EXPECT_EQ(decisions.back().reason == BlindReason::standstill, rests) << decisions.back().time_s;
      const bool learning = !rests && decisions.back().time_s < 0.59;
      EXPECT_EQ(decisions.back().reason == BlindReason::learning, learning) << decisions.back().time_s;
      EXPECT_EQ(decisions.back().state == State::blind, rests || learning) << decisions.back().time_s;
    }
    EXPECT_GT(first_alarm_s(decisions), 1.0) << rest_rpm;
    EXPECT_LT(first_alarm_s(decisions), 1.4) << rest_rpm;
    EXPECT_EQ(decisions.back().state, State::chatter) << rest_rpm;
  }
}

// Pulses end where the spindle stops: after two seconds without one at 30 rpm, and not before.
TEST(OrderDetector, StandsStillWherePulsesEnd) {
  SyntheticCut cut{.sample_rate_hz = 2560.0, .seconds = 8.0};
  std::vector<float> both = with_pulses(cut, 1, 0.0, 5.0);
  constexpr double stops_s = 1.5, starts_s = 6.0;
  Random random(3);
  for (std::size_t i = 0; i < both.size() / 2; ++i) {
    const double time_s = static_cast<double>(i) / cut.sample_rate_hz;
    if (time_s < stops_s || time_s > starts_s) continue;
    both[2 * i] = static_cast<float>(0.05 * random.normal());
    both[2 * i + 1] = static_cast<float>(0.02 * random.normal());
  }
  cut.channels = 2;
  for (const double hint_off : {0.0, -1.0}) {
    MonitorOptions options = options_for(cut, hint_off);
    options.tachometer_channel = 1;
    for (const Decision& d : decisions_of(options, both)) {
      const bool rests = d.time_s > stops_s + 2.1 && d.time_s < starts_s;
      if (rests) {
        EXPECT_EQ(d.reason, BlindReason::standstill) << d.time_s;
      } else if (d.time_s < stops_s + 1.9 || d.time_s > starts_s + 0.1) {
        EXPECT_NE(d.reason, BlindReason::standstill) << d.time_s;
      }
    }
  }
}

// A comb with a line for each multiple of 0.05 rpm took minutes for what takes some 5 ms: ctest's limit would show it.
TEST(OrderDetector, NoSpeedCostsMore) {
  const SyntheticCut cut{.seconds = 0.5};
  const std::vector<float> x = vibration(cut);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double min_rpm : {1.0, 30.0}) {
    for (const double rpm : {0.0, 0.05, 1.0, 31.0, 299.0, 301.0, 3e5, 1e7, 1e300, infinity, -3000.0, -infinity,
                             std::numeric_limits<double>::quiet_NaN()}) {
      MonitorOptions options = options_for(cut);
      options.min_speed_rad_per_s = min_rpm * units::rpm;
      ChatterMonitor monitor(options);
      const std::size_t block = options.hop_samples();
      for (std::size_t at = 0; at + block <= x.size(); at += block) {
        monitor.set_spindle_speed(rpm * units::rpm * (at / block % 2 == 0 ? 1.0 : 1.3));  // unsteady
        EXPECT_TRUE(std::isfinite(monitor.push(std::span(x).subspan(at, block)).score)) << rpm;
      }
    }
  }
}

// Chatter that lasts when the speed is said to be 0 does not vanish; none begins then, whatever is heard.
TEST(OrderDetector, AStandstillHidesNoAlarmAndBeginsNone) {
  const SyntheticCut cut{.chatter_hz = 683.0, .starts_s = 1.0, .ends_s = 2.0, .seconds = 3.0};
  const std::vector<float> x = vibration(cut);
  for (const double stops_s : {0.5, 1.6}) {
    const MonitorOptions options = options_for(cut);
    ChatterMonitor monitor(options);
    const std::size_t block = options.hop_samples();
    bool alarm = false;
    for (std::size_t at = 0; at + block <= x.size(); at += block) {
      const double time_s = static_cast<double>(at) / cut.sample_rate_hz;
      if (time_s > stops_s) monitor.set_spindle_speed(0.0);
      const Decision d = monitor.push(std::span(x).subspan(at, block));
      alarm = alarm || d.state == State::chatter;
      if (time_s > stops_s && d.state != State::chatter) {
        EXPECT_EQ(d.reason, BlindReason::standstill) << time_s;
        EXPECT_EQ(d.spindle_speed_rad_per_s, 0.0) << time_s;
        EXPECT_EQ(d.faults & speed_unknown, 0U) << time_s;
      }
      if (stops_s == 1.6 && time_s > 1.7 && time_s < 1.9) {
        EXPECT_EQ(d.state, State::chatter) << time_s;
      }
    }
    EXPECT_EQ(alarm, stops_s == 1.6);
  }
}

TEST(OrderDetector, FindsTheCombOfACutWithoutAHint) {
  const SyntheticCut cut{.rotation_hz = 71.0, .chatter_hz = 660.0, .seconds = 3.5};
  MonitorOptions options = options_for(cut);
  options.spindle_speed_rad_per_s = 0.0;
  const std::vector<Decision> decisions = decisions_of(options, vibration(cut));
  for (const Decision& d : decisions)
    EXPECT_TRUE(d.state != State::blind || d.reason == BlindReason::learning) << d.time_s;
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

// The mains appear as combs at 50 and 60 Hz and whole parts of them; a spindle may turn at their multiples.
TEST(OrderDetector, FollowsSpeedsAtMultiplesOfTheMains) {
  for (const double rotation_hz : {100.0, 150.0, 239.7, 240.0}) {
    const SyntheticCut cut{.rotation_hz = rotation_hz, .channels = 2, .seconds = 2.0};
    const double last = decisions_of(options_for(cut), vibration(cut)).back().spindle_speed_rad_per_s;
    EXPECT_NEAR(last, turn * rotation_hz, 1e-3 * turn * rotation_hz);
  }
}

TEST(OrderDetector, StaysQuietWhileTheSpeedDrifts) {
  for (const auto& [rotation, drift] : {std::pair{43.0, -1.2}, std::pair{80.0, 4.0}, std::pair{130.0, -13.0}}) {
    const SyntheticCut cut{.rotation_hz = rotation, .drift_hz_per_s = drift, .channels = 2, .noise = 0.03};
    const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
    EXPECT_EQ(first_alarm_s(decisions), -1.0) << rotation;
    const double last = turn * (rotation + drift);
    EXPECT_NEAR(decisions.back().spindle_speed_rad_per_s, last, 1e-3 * last);
  }
}

// The speed drifts to 9 % below a hint that scatters from hop to hop; the tool leaves, and comes back at that speed.
// A hint that says another speed makes it forgotten.
TEST(OrderDetector, KnowsTheSpeedFollowedLastWhileTheHintTrembles) {
  const SyntheticCut cut{.rotation_hz = 80.0, .drift_hz_per_s = -6.0, .channels = 2, .noise = 0.03, .seconds = 6.0};
  std::vector<float> x = vibration(cut);
  Random random(3);
  const auto frame = [&](double s) { return 2 * static_cast<std::size_t>(s * cut.sample_rate_hz); };
  for (std::size_t i = frame(4.0); i < frame(5.0); ++i) x[i] = static_cast<float>(0.03 * random.normal());
  const auto found_s = [&](double trembles, double hint_share) {
    const MonitorOptions options = options_for(cut);
    ChatterMonitor monitor(options);
    const std::size_t block = options.hop_samples() * 2;
    for (std::size_t at = 0; at + block <= x.size(); at += block) {
      const Decision d = monitor.push(std::span(x).subspan(at, block));
      if (d.time_s > 5.0 && std::abs(d.spindle_speed_rad_per_s / (turn * 74.0) - 1.0) < 2e-3) return d.time_s - 5.0;
      const double share = d.time_s > 4.5 ? hint_share : 1.0;
      monitor.set_spindle_speed(options.spindle_speed_rad_per_s * share * (1.0 + trembles * random.uniform(-1.0, 1.0)));
    }
    return 1e9;
  };
  EXPECT_LT(found_s(0.0, 1.0), 0.2);
  EXPECT_LT(found_s(1e-3, 1.0), 0.2);
  EXPECT_GT(found_s(1e-3, 1.1), 0.2);
}

// A quarter of such a hop is longer than the look in which the speed is found.
TEST(OrderDetector, FollowsTheSpeedInLongHops) {
  const SyntheticCut cut{.seconds = 8.0};
  MonitorOptions options = options_for(cut);
  options.hop_s = 0.6;
  options.window_s = 0.6;
  for (const Decision& d : decisions_of(options, vibration(cut)))
    EXPECT_NEAR(d.spindle_speed_rad_per_s, turn * 80.0, 2e-3 * turn * 80.0) << d.hop;
}

TEST(OrderDetector, FollowsATachometer) {
  SyntheticCut cut{.channels = 1, .chatter_hz = 683.0};
  const std::vector<float> x = vibration(cut);
  std::vector<float> both;
  for (std::size_t i = 0; i < x.size(); ++i) {
    both.push_back(x[i]);
    both.push_back(std::fmod(cut.rotation_hz * static_cast<double>(i) / cut.sample_rate_hz, 1.0) < 0.1 ? 5.0F : 0.0F);
  }
  cut.channels = 2;
  MonitorOptions options = options_for(cut);
  options.spindle_speed_rad_per_s = 0.0;
  options.tachometer_channel = 1;
  const std::vector<Decision> decisions = decisions_of(options, both);
  EXPECT_NEAR(decisions[60].spindle_speed_rad_per_s, turn * 80.0, 1e-3 * turn * 80.0);
  const double alarm = first_alarm_s(decisions);
  EXPECT_GT(alarm, 2.0);
  EXPECT_LT(alarm, 2.35);
  EXPECT_EQ(decisions.back().channel, 0);
}

TEST(OrderDetector, SuggestsTheSampleRateThatFitsTheComb) {
  const SyntheticCut cut{.sample_rate_hz = 20480.0, .seconds = 6.0};
  MonitorOptions options = options_for(cut, 0.0);
  options.sample_rate_hz = 10240.0;
  const Decision last = decisions_of(options, vibration(cut)).back();
  EXPECT_TRUE(last.faults & wrong_sample_rate);
  EXPECT_NEAR(last.suggested_sample_rate_hz, 20480.0, 50.0);
  for (const Decision& d : decisions_of(options_for(cut), vibration(cut))) EXPECT_FALSE(d.faults & wrong_sample_rate);
}

// Growth so slow that the comb takes it off: the harmonic's amplitude against what was learnt of it shows it.
TEST(OrderDetector, DetectsSynchronousChatter) {
  for (const auto& [teeth, harmonic, kind] :
       {std::tuple{3, 7, SynchronousChatter::locked}, std::tuple{2, 7, SynchronousChatter::period_doubling},
        std::tuple{4, 6, SynchronousChatter::period_doubling}}) {
    const SyntheticCut cut{
        .teeth = teeth, .chatter_hz = 80.0 * harmonic, .growth_per_s = 3.0, .chatter = 3.0, .seconds = 7.0};
    const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
    EXPECT_GT(first_alarm_s(decisions), 2.0) << teeth;
    EXPECT_TRUE(std::ranges::any_of(decisions, [&, want = kind](const Decision& d) { return d.synchronous == want; }))
        << teeth;
    EXPECT_NEAR(decisions.back().chatter_frequency_hz, cut.chatter_hz, 5.0) << teeth;
  }
}

// Slower than eight turns in the longest window only the tests remain that need no orders: they judge, so the monitor
// is not blind, and the explanation has no belief in a speed.
TEST(OrderDetector, JudgesASlowSpindleByItsLineAlone) {
  for (const double rpm : {120.0, 200.0}) {
    SyntheticCut cut{.rotation_hz = rpm / 60.0, .teeth = 1, .chatter_hz = 97.3, .growth_per_s = 4.0, .chatter = 6.0};
    cut.sample_rate_hz = 2048.0;
    cut.starts_s = 0.5;
    const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
    EXPECT_GT(first_alarm_s(decisions), 1.5) << rpm;
    for (const Decision& d : decisions) {
      EXPECT_NE(d.reason, BlindReason::speed_unknown);
      EXPECT_EQ(d.why.speed_belief, 0.0F);
      if (d.state != State::chatter) continue;
      EXPECT_EQ(d.why.test, monitor::Test::dominant);
      EXPECT_NEAR(d.chatter_frequency_hz, cut.chatter_hz, 1.0);
    }
  }
}

}  // namespace order_detector_test
