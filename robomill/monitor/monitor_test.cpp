#include "robomill/monitor/monitor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/allocations.hpp"
#include "testing/monitor/decisions.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace monitor_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::decisions_of;
using monitor::testing::first_alarm_s;
using monitor::testing::options_for;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

TEST(MonitorOptions, PulsesComeAtLessThanHalfTheSampleRate) {
  MonitorOptions options{
      .sample_rate_hz = 10'240.0, .channels = 2, .tachometer_channel = 1, .pulses_per_revolution = 60};
  options.spindle_speed_rad_per_s = 85.0 * 2.0 * std::numbers::pi;
  EXPECT_NO_THROW(options.validate());
  options.spindle_speed_rad_per_s = 86.0 * 2.0 * std::numbers::pi;
  EXPECT_THROW(options.validate(), InvalidInput);
  options.tachometer_channel = -1;
  EXPECT_NO_THROW(options.validate());
}

TEST(ChatterMonitor, DecidesOnceAHopWhateverTheBlocks) {
  ChatterMonitor monitor({.sample_rate_hz = 10240.0, .channels = 2});
  EXPECT_EQ(monitor.frames_to_next_decision(), 256U);
  const std::vector<float> odd(333, 0.0F);
  std::size_t pushed = 0;
  Decision decision;
  while (pushed < 10 * 512) {
    decision = monitor.push(odd);
    pushed += odd.size();
    EXPECT_EQ(decision.hop, pushed / 512);
  }
  EXPECT_DOUBLE_EQ(decision.time_s, (10.0 * 256.0 - 1.0) / 10240.0);
}

constexpr std::size_t hop_frames = 256;  // 25 ms at 10,240 Hz

MonitorOptions options_of(int channels, Kind kind = Kind::comb_cusum) {
  return {.kind = kind,
          .sample_rate_hz = 10'240.0,
          .channels = channels,
          .spindle_speed_rad_per_s = 300.0,
          .threshold = 1e300};
}

/// White noise of rms 1, of which spoil(channel, value) gives what the monitor is given.
template <class Spoil>
Decision push_hop(ChatterMonitor& monitor, int channels, Random& random, Spoil&& spoil) {
  std::vector<float> samples;
  for (std::size_t i = 0; i < hop_frames; ++i) {
    for (int c = 0; c < channels; ++c) samples.push_back(spoil(c, static_cast<float>(random.normal())));
  }
  return monitor.push(samples);
}

/// Hops of noise after which the default detector has learnt: three seconds.
constexpr int learnt_hops = 120;

/// Nothing is wrong with the input, whether the detector has learnt yet or not.
bool hears(const Decision& decision) {
  return decision.state != State::blind || decision.reason == BlindReason::learning;
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
const auto as_it_is = [](int, float x) { return x; };

// The pulses stand at 0 or 5, so that alone they would be clipped, stuck and the loudest of all.
TEST(ChatterMonitor, ATachometerIsNoVibration) {
  MonitorOptions options = options_of(2);
  options.tachometer_channel = 1;
  options.full_scale = 5.0;
  ChatterMonitor monitor(options);
  Random random(1);
  for (std::size_t hop = 0; hop < 40; ++hop) {
    std::vector<float> samples;
    for (std::size_t i = 0; i < hop_frames; ++i) {
      samples.push_back(static_cast<float>(random.normal()));
      samples.push_back((hop * hop_frames + i) % 215 < 100 || hop >= 20 ? 5.0F : 0.0F);
    }
    const Decision decision = monitor.push(samples);
    EXPECT_EQ(decision.faults & (clipped | stuck | dead_channel), 0U) << hop;
    EXPECT_NEAR(decision.level, 1.0, 0.3) << hop;
    EXPECT_TRUE(hears(decision)) << hop;
  }
  // Vibration of 1e-5 beside pulses of 5 V is not dead.
  const Decision decision = push_hop(monitor, 2, random, [](int c, float x) { return c == 1 ? 5.0F * x : 1e-5F * x; });
  EXPECT_EQ(decision.faults & dead_channel, 0U);
  EXPECT_TRUE(hears(decision));
  // That it is not finite is a fault of the input, and leaves the vibration.
  const Decision lost = push_hop(monitor, 2, random, [](int c, float x) { return c == 1 ? nan : x; });
  EXPECT_NE(lost.faults & not_finite, 0U);
  EXPECT_TRUE(hears(lost));
}

TEST(ChatterMonitor, IsBlindWhereNoChannelHasASignal) {
  for (const Kind kind : {Kind::comb_cusum, Kind::energy_entropy}) {
    ChatterMonitor monitor(options_of(2, kind));
    Random random(1);
    const auto push = [&](auto spoil) { return push_hop(monitor, 2, random, spoil); };
    EXPECT_TRUE(hears(push(as_it_is)));
    EXPECT_TRUE(hears(push([](int c, float x) { return c == 0 ? nan : x; })));
    for (int i = 0; i < learnt_hops; ++i) EXPECT_TRUE(hears(push(as_it_is)));
    // One is stuck, the other not finite.
    Decision decision = push([](int c, float) { return c == 0 ? 0.5F : infinity; });
    EXPECT_EQ(decision.state, State::blind);
    EXPECT_EQ(decision.reason, BlindReason::no_signal);
    EXPECT_TRUE(decision.changed);
    EXPECT_EQ(decision.chatter_frequency_hz, 0.0);
    // Left out until they have been well for 0.3 s, the hop at hand among it.
    for (int i = 0; i < 11; ++i) {
      decision = push(as_it_is);
      EXPECT_EQ(decision.reason, BlindReason::no_signal);
      EXPECT_FALSE(decision.changed);
    }
    decision = push(as_it_is);
    EXPECT_NE(decision.state, State::blind);
    EXPECT_EQ(decision.reason, BlindReason::none);
    EXPECT_TRUE(decision.changed);
  }
}

// What is filled in for lost samples is NaN in every channel; a sensor's fault is not.
TEST(ChatterMonitor, DistinguishesAGapFromAMissingSignal) {
  const auto reason_of = [](int channels, int tachometer, auto spoil) {
    MonitorOptions options = options_of(channels);
    options.tachometer_channel = tachometer;
    ChatterMonitor monitor(options);
    Random random(1);
    for (int i = 0; i < learnt_hops; ++i) (void)push_hop(monitor, channels, random, as_it_is);
    return push_hop(monitor, channels, random, spoil).reason;
  };
  const auto lost = [](int, float) { return nan; };
  EXPECT_EQ(reason_of(1, -1, lost), BlindReason::gap);
  EXPECT_EQ(reason_of(2, -1, lost), BlindReason::gap);
  EXPECT_EQ(reason_of(2, 1, lost), BlindReason::gap);
  EXPECT_EQ(reason_of(2, 1, [](int c, float x) { return c == 0 ? nan : x; }), BlindReason::no_signal);
  EXPECT_EQ(reason_of(2, -1, [](int, float) { return infinity; }), BlindReason::no_signal);
  EXPECT_EQ(reason_of(2, -1, [](int, float) { return 0.0F; }), BlindReason::no_signal);
  // A hop of which a third is lost is judged.
  EXPECT_EQ(reason_of(1, -1, [i = 0](int, float x) mutable { return i++ % 3 == 0 ? nan : x; }), BlindReason::none);
}

TEST(ChatterMonitor, IsBlindWhereEverySignalStaysClipped) {
  MonitorOptions options = options_of(2);
  options.full_scale = 1.0;
  ChatterMonitor monitor(options);
  Random random(1);
  const auto both = [](int, float x) { return std::clamp(x, -1.0F, 1.0F); };
  const auto one = [](int c, float x) { return c == 0 ? std::clamp(x, -1.0F, 1.0F) : 0.1F * x; };
  for (int i = 0; i < learnt_hops; ++i) EXPECT_TRUE(hears(push_hop(monitor, 2, random, one)));
  for (int i = 0; i < 3; ++i) EXPECT_NE(push_hop(monitor, 2, random, both).state, State::blind);
  EXPECT_EQ(push_hop(monitor, 2, random, both).reason, BlindReason::clipped);
  // A channel without a signal cannot speak for the clipped one.
  EXPECT_EQ(
      push_hop(monitor, 2, random, [](int c, float x) { return c == 0 ? std::clamp(x, -1.0F, 1.0F) : 0.0F; }).reason,
      BlindReason::clipped);
  // Its run of zeros reaches into the next hop, and then it is left out for 0.3 s.
  for (int i = 0; i < 12; ++i) EXPECT_EQ(push_hop(monitor, 2, random, one).reason, BlindReason::clipped);
  EXPECT_NE(push_hop(monitor, 2, random, one).state, State::blind);
}

// A spindle at rest before a 16-bit converter: hum of three counts, whose tops are flat.
TEST(ChatterMonitor, StepsOfAConverterAreNotClipped) {
  for (const double full_scale : {32'768.0, 0.0}) {
    MonitorOptions options = options_of(1);
    options.full_scale = full_scale;
    ChatterMonitor monitor(options);
    Random random(1);
    Decision decision;
    for (std::size_t hop = 0; hop < 20; ++hop) {
      std::size_t i = hop * hop_frames;
      decision = push_hop(monitor, 1, random, [&](int, float) {
        return static_cast<float>(std::round(3.0 * std::sin(0.06 * static_cast<double>(i++))));
      });
    }
    EXPECT_EQ((decision.faults & clipped) != 0, full_scale == 0.0);  // where it is not known they might be
  }
}

TEST(ChatterMonitor, IsBlindWhileTheSpindleStandsStill) {
  for (const Kind kind : {Kind::comb_cusum, Kind::energy_entropy}) {
    MonitorOptions options = options_of(1, kind);
    options.threshold = -1.0;  // whatever there is exceeds it
    ChatterMonitor monitor(options);
    Random random(1);
    monitor.set_spindle_speed(2.0);  // 19 rpm
    for (int i = 0; i < 20; ++i) EXPECT_EQ(push_hop(monitor, 1, random, as_it_is).reason, BlindReason::standstill) << i;
    // What is wrong with the input stands before it.
    EXPECT_EQ(push_hop(monitor, 1, random, [](int, float) { return nan; }).reason, BlindReason::gap);
    monitor.reset();
    EXPECT_EQ(push_hop(monitor, 1, random, as_it_is).reason, BlindReason::standstill);
    monitor.set_spindle_speed(300.0);
    EXPECT_NE(push_hop(monitor, 1, random, as_it_is).reason, BlindReason::standstill);
    monitor.set_spindle_speed(0.0);
    monitor.set_spindle_speed(std::numeric_limits<double>::quiet_NaN());  // not known is not still
    EXPECT_NE(push_hop(monitor, 1, random, as_it_is).reason, BlindReason::standstill);
  }
}

TEST(ChatterMonitor, ForgetsOnResetWhyItWasBlind) {
  ChatterMonitor monitor(options_of(1));
  Random random(1);
  (void)push_hop(monitor, 1, random, as_it_is);
  EXPECT_EQ(push_hop(monitor, 1, random, [](int, float) { return nan; }).state, State::blind);
  monitor.reset();
  EXPECT_EQ(push_hop(monitor, 1, random, as_it_is).reason, BlindReason::learning);
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

// The window of the orders is 0.3 s long: what stood in the place of a lost signal would be taken for vibration. Of two
// channels the one that rested at 50 times the vibration's amplitude says nothing until its window is good again.
TEST(ChatterMonitor, LeavesAChannelOutForAsLongAsItsWindowHoldsWhatWasBad) {
  const SyntheticCut cut{.channels = 2, .noise = 0.03, .seconds = 6.0};
  const std::vector<float> good = vibration(cut);
  std::vector<float> bad = good;
  for (std::size_t i = 30720; i < 33280; ++i) bad[2 * i] = 50.0F;
  const std::vector<Decision> expected = decisions_of(options_for(cut), good);
  const std::vector<Decision> decisions = decisions_of(options_for(cut), bad);
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    EXPECT_EQ(decisions[i].state, expected[i].state) << decisions[i].time_s;
    EXPECT_NEAR(decisions[i].spindle_speed_rad_per_s, expected[i].spindle_speed_rad_per_s, 0.5) << decisions[i].time_s;
    if (i == 0 || decisions[i].time_s < 3.0) continue;
    EXPECT_NEAR(decisions[i].energy_entropy, expected[i].energy_entropy, 1.2) << decisions[i].time_s;
  }
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

TEST(MonitorOptions, LookBackAsFarAsTheDetectorDoes) {
  EXPECT_EQ(MonitorOptions{}.look_back_s(), 0.3);
  EXPECT_EQ(MonitorOptions{.window_s = 2.0}.look_back_s(), 0.3);
  EXPECT_EQ((MonitorOptions{.kind = Kind::energy_entropy, .window_s = 0.05}.look_back_s()), 0.3);
  EXPECT_EQ((MonitorOptions{.kind = Kind::energy_entropy, .window_s = 2.0}.look_back_s()), 4.0);
}

TEST(MonitorOptions, RejectWhatMakesNoSense) {
  const auto field = [](const MonitorOptions& options) { return test::field_of([&] { options.validate(); }); };
  EXPECT_EQ(field({}), "sample_rate_hz");
  EXPECT_EQ(field({.sample_rate_hz = 1e4}), "accepted");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .channels = 0}), "channels");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .channels = 2, .tachometer_channel = 2}), "tachometer_channel");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .tachometer_channel = 0}), "tachometer_channel");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .spindle_speed_rad_per_s = std::nan("")}), "spindle_speed_rad_per_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .spindle_speed_rad_per_s = 3.0}), "spindle_speed_rad_per_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .min_speed_rad_per_s = 0.1}), "min_speed_rad_per_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .min_speed_rad_per_s = std::nan("")}), "min_speed_rad_per_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .window_s = 0.01}), "window_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .hop_s = 1e-4}), "hop_s");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .bands = 65}), "bands");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .false_alarms_per_hour = 0.0}), "false_alarms_per_hour");
  EXPECT_EQ(field({.sample_rate_hz = 1e4, .full_scale = -1.0}), "full_scale");
}

}  // namespace monitor_test
