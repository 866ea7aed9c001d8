// The default detector on signals that are known to the last term, and what any input does to the monitor.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/tachometer.hpp"
#include "testing/allocations.hpp"
#include "testing/monitor/decisions.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace detector_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::decisions_of;
using monitor::testing::first_alarm_s;
using monitor::testing::options_for;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

constexpr double turn = 2.0 * std::numbers::pi;

TEST(Tachometer, CountsPulsesBetweenSamples) {
  Tachometer pulses(10240.0, 1);
  std::vector<double> x;
  for (int i = 0; i < 20480; ++i) {
    const double phase = std::fmod(73.3 * i / 10240.0, 1.0);
    x.push_back(5.0 * std::exp(-std::pow((phase - 0.5) / 0.03, 2)) + 0.01 * std::sin(0.1 * i));
  }
  EXPECT_EQ(pulses.rotation_hz(), 0.0);
  pulses.push(x);
  EXPECT_NEAR(pulses.rotation_hz(), 73.3, 0.02);
  pulses.push(std::vector<double>(1000, 0.0));
  EXPECT_EQ(pulses.rotation_hz(), 0.0);
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
      if (d.time_s > 3.6) {
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

TEST(ChatterMonitor, LivesOnWithBadInput) {
  const SyntheticCut cut{.channels = 2, .chatter_hz = 683.0, .starts_s = 5.0, .seconds = 7.0};
  const std::vector<float> good = vibration(cut);
  const auto faults_of = [&](auto spoil) {
    std::vector<float> x = good;
    for (std::size_t i = 30720; i < 35840; ++i) spoil(x[2 * i], i);
    const std::vector<Decision> decisions = decisions_of(options_for(cut), x);
    std::uint32_t faults = 0;
    for (const Decision& d : decisions) {
      EXPECT_TRUE(std::isfinite(d.score) && std::isfinite(d.level) && std::isfinite(d.chatter_frequency_hz));
      if (d.time_s > 3.0 && d.time_s < 3.5) faults |= d.faults;
      if (d.time_s > 4.0) {
        EXPECT_EQ(d.faults & ~std::uint32_t{speed_unknown}, 0U);
      }
    }
    const double alarm = first_alarm_s(decisions);
    EXPECT_GT(alarm, 5.0);
    EXPECT_LT(alarm, 5.35);
    return faults;
  };
  EXPECT_TRUE(faults_of([](float& x, std::size_t i) {
                if (i % 3 == 0) x = std::numeric_limits<float>::quiet_NaN();
                if (i % 3 == 1) x = std::numeric_limits<float>::infinity();
              }) &
              not_finite);
  EXPECT_TRUE(faults_of([](float& x, std::size_t) { x = 0.25F; }) & stuck);
  EXPECT_TRUE(faults_of([](float& x, std::size_t) { x = 0.0F; }) & (stuck | dead_channel));
  EXPECT_FALSE(faults_of([](float&, std::size_t) {}) & ~std::uint32_t{speed_unknown});
}

TEST(ChatterMonitor, NoticesClippingAndDeadChannels) {
  const SyntheticCut cut{.channels = 2, .seconds = 1.0};
  std::vector<float> x = vibration(cut);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = i % 2 == 1 ? 0.0F : std::clamp(x[i], -1.5F, 1.5F);
  MonitorOptions options = options_for(cut);
  EXPECT_TRUE(decisions_of(options, x).back().faults & clipped);
  EXPECT_TRUE(decisions_of(options, x).back().faults & dead_channel);
  options.full_scale = 1.5;
  EXPECT_TRUE(decisions_of(options, x).back().faults & clipped);
  options.full_scale = 10.0;
  EXPECT_FALSE(decisions_of(options, vibration(cut)).back().faults & clipped);
}

TEST(ChatterMonitor, SameDecisionsInAnyBlocksAndAfterReset) {
  const SyntheticCut cut{.channels = 2, .chatter_hz = 683.0, .seconds = 3.0};
  const std::vector<float> x = vibration(cut);
  const std::vector<Decision> whole = decisions_of(options_for(cut), x);
  ChatterMonitor monitor(options_for(cut));
  Random random(5);
  for (int pass = 0; pass < 2; ++pass) {
    std::size_t at = 0;
    while (at < x.size()) {
      const std::size_t n = std::min<std::size_t>(1 + random.index(700), x.size() - at);
      const Decision d = monitor.push(std::span(x).subspan(at, n));
      at += n;
      if (d.hop == 0 || d.hop > whole.size()) continue;
      const Decision& same = whole[d.hop - 1];
      ASSERT_EQ(d.score, same.score) << d.hop;
      ASSERT_EQ(d.state, same.state) << d.hop;
      ASSERT_EQ(d.chatter_frequency_hz, same.chatter_frequency_hz) << d.hop;
    }
    monitor.reset();
  }
}

TEST(ChatterMonitor, AllocatesNothing) {
  for (const Kind kind : {Kind::comb_cusum, Kind::energy_entropy}) {
    const SyntheticCut cut{.channels = 2, .chatter_hz = 683.0, .ends_s = 3.0};
    std::vector<float> x = vibration(cut);
    x[50000] = std::numeric_limits<float>::quiet_NaN();
    MonitorOptions options = options_for(cut);
    options.kind = kind;
    options.threshold = 1e9;
    ChatterMonitor monitor(options);
    bool detected = false;
    const std::size_t taken = test::allocations([&] {
      for (std::size_t at = 0; at + 512 <= x.size(); at += 512) {
        detected = monitor.push(std::span(x).subspan(at, 512)).state == State::chatter || detected;
      }
      monitor.set_spindle_speed(300.0);
      monitor.reset();
    });
    EXPECT_EQ(taken, 0U);
    EXPECT_TRUE(detected || kind == Kind::energy_entropy);
  }
}

}  // namespace detector_test
