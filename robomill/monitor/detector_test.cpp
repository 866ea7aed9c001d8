// Parts of the default detector, and the whole of it on signals that are known to the last term.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/comb_cusum/comb.hpp"
#include "robomill/monitor/comb_cusum/cusum.hpp"
#include "robomill/monitor/comb_cusum/frequency.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/monitor/spindle/speed.hpp"
#include "robomill/monitor/spindle/spindle.hpp"
#include "robomill/monitor/spindle/tachometer.hpp"
#include "testing/allocations.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace detector_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

constexpr double turn = 2.0 * std::numbers::pi;

MonitorOptions options_for(const SyntheticCut& cut, double hint_off = 0.02) {
  return {.sample_rate_hz = cut.sample_rate_hz,
          .channels = cut.channels,
          .spindle_speed_rad_per_s = turn * cut.rotation_hz * (1.0 + hint_off),
          .teeth = cut.teeth};
}

std::vector<Decision> decisions_of(const MonitorOptions& options, const std::vector<float>& samples) {
  ChatterMonitor monitor(options);
  const std::size_t block = options.hop_samples() * static_cast<std::size_t>(options.channels);
  std::vector<Decision> out;
  for (std::size_t at = 0; at + block <= samples.size(); at += block) {
    out.push_back(monitor.push(std::span(samples).subspan(at, block)));
  }
  return out;
}

double first_alarm_s(const std::vector<Decision>& decisions) {
  const auto found = std::ranges::find(decisions, State::chatter, &Decision::state);
  return found == decisions.end() ? -1.0 : found->time_s;
}

// What repeats every turn goes, another line stays: 1 - 1/(1 + i 2π Δf τ) with 13 Hz to the next harmonic.
TEST(Comb, TakesHarmonicsAndLeavesTheRest) {
  constexpr double rate = 10240.0;
  constexpr double rotation = 80.0;
  Comb comb(60);
  comb.set_harmonics(60);
  double angle = 0.0;
  double worst = 0.0;
  double left = 0.0;
  std::vector<float> x(64), r(64);
  for (std::size_t at = 0; at < 40960; at += 64) {
    for (std::size_t i = 0; i < 64; ++i) {
      const double t = static_cast<double>(at + i) / rate;
      x[i] = static_cast<float>(std::cos(turn * 3.0 * rotation * t) + 0.5 * std::sin(turn * 17.0 * rotation * t) +
                                0.2 * std::cos(turn * 653.0 * t));
    }
    comb.run(x, r, angle, turn * rotation / rate, 1.0 - std::exp(-64.0 / (0.25 * rate)), 1e9);
    angle += 64.0 * turn * rotation / rate;
    for (std::size_t i = 0; at > 30720 && i < 64; ++i) {
      const double t = static_cast<double>(at + i) / rate;
      worst = std::max(worst, std::abs(static_cast<double>(r[i]) - 0.2 * std::cos(turn * 653.0 * t)));
      left += static_cast<double>(r[i] * r[i]) / 10176.0;
    }
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_NEAR(std::sqrt(2.0 * left), 0.2, 0.01);
  EXPECT_NEAR(std::abs(comb.amplitude(3)), 1.0, 0.02);
}

TEST(SpeedSearch, FindsTheCombNearAHintAndFarFromAny) {
  for (const double rotation : {31.0, 80.0, 212.5}) {
    const std::vector<float> x = vibration({.rotation_hz = rotation, .seconds = 1.0});
    SpeedSearch search(10240.0, 1);
    search.push(x, x.size());
    search.begin(3, 0.93 * rotation, 1.07 * rotation, 3);
    EXPECT_TRUE(search.advance(1000000));
    EXPECT_NEAR(search.best_hz(), rotation, std::max(0.05, 5e-4 * rotation));
    EXPECT_GT(search.best_score(), 9.0);
    search.begin(3, 0.4 * rotation, 2.5 * rotation, 3);
    while (!search.advance(100)) {
    }
    EXPECT_NEAR(search.best_hz(), rotation, std::max(0.05, 5e-4 * rotation));
  }
  const std::vector<float> noise = vibration({.teeth = 0, .noise = 100.0, .seconds = 1.0});
  SpeedSearch search(10240.0, 1);
  search.push(noise, noise.size());
  search.begin(3, 75.0, 85.0, 3);
  search.advance(1000000);
  EXPECT_LT(search.best_score(), 5.0);
}

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

// Wald: of exponential energies, independent from hop to hop, no more sums pass h than the threshold was set for; and a
// line that stands out is reported at once.
TEST(Cusum, KeepsTheFalseAlarmsThatWereAskedFor) {
  constexpr std::size_t lines = 60;
  constexpr double an_hour = 3600.0;
  Cusum test({.lines = lines, .hop_s = 0.025, .false_alarms_per_hour = an_hour});
  Random random(7);
  std::vector<double> energy(lines);
  const std::vector<double> nothing(lines, 0.0);
  const std::array<bool, 1> steady = {false};
  const int hops = 10 * test::seeds(14400);
  int alarms = 0;
  for (int hop = 0; hop < hops; ++hop) {
    for (double& e : energy) e = -std::log(1.0 - random.uniform());
    if (test.step(energy, nothing, steady).score > test.threshold()) {
      ++alarms;
      test.clear();
    }
    test.learn();
  }
  EXPECT_LT(alarms, an_hour * hops * 0.025 / 3600.0);
  Cusum::Verdict verdict;
  int needed = 0;
  while (verdict.score <= test.threshold() && needed < 20) {
    for (double& e : energy) e = -std::log(1.0 - random.uniform());
    energy[17] *= 20.0;
    verdict = test.step(energy, nothing, steady);
    ++needed;
  }
  EXPECT_EQ(verdict.line, 17U);
  EXPECT_LE(needed, 12);
}

// A knock rings off in one channel and beats into the other.
TEST(Cusum, AddsNothingWhereTheChannelThatStandsHighestFalls) {
  constexpr std::size_t lines = 60;
  Random random(9);
  Cusum test({.lines = lines, .channels = 2});
  std::vector<double> energy(2 * lines);
  const std::vector<double> nothing(2 * lines, 0.0);
  const auto hop = [&](double first, double second, std::array<bool, 2> falls) {
    for (double& e : energy) e = -std::log(1.0 - random.uniform());
    energy[17] = first;
    energy[lines + 17] = second;
    return test.step(energy, nothing, falls).score;
  };
  for (int k = 0; k < 100; ++k) {
    hop(0.5, 0.5, {});
    test.learn();
  }
  test.clear();
  EXPECT_LT(hop(1e3, 1e2, {true, false}), 0.2 * test.threshold());
  EXPECT_GE(hop(1e3, 1e2, {false, false}), 0.5 * test.threshold());
}

// The other side of the test: where a line has fallen for good, so has its baseline in half a second and not in two.
TEST(Cusum, GivesUpABaselineThatIsTooHigh) {
  constexpr std::size_t lines = 60;
  Cusum test({.lines = lines});
  Random random(8);
  std::vector<double> energy(lines);
  const std::vector<double> nothing(lines, 0.0);
  const std::array<bool, 1> steady = {false};
  const auto hops = [&](int count, double level) {
    for (int hop = 0; hop < count; ++hop) {
      for (double& e : energy) e = -std::log(1.0 - random.uniform());
      energy[17] *= level;
      test.step(energy, nothing, steady);
      test.learn();
    }
  };
  hops(200, 1.0);
  hops(20, 0.01);
  double before = 0.0;
  for (int hop = 0; hop < 20; ++hop) {
    hops(1, 0.01);
    before += test.height(0, 17) / 20.0;
  }
  EXPECT_GT(before, -1.5);  // at the lower level it is no longer far below: ln 100 = 4.6
  hops(20, 1.0);
  EXPECT_GT(test.sum(17), test.threshold());
}

// The standard deviation covers the error: at least 90 % within two of them, and it is no more than three times too
// wide.
TEST(Frequency, IsAsSureAsItSays) {
  Random random(11);
  FrequencyRing ring(10240.0, 0.3);
  const int runs = test::seeds(1000);
  int within = 0;
  double squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    const double f = random.uniform(100.0, 4000.0), phase = random.uniform(0.0, turn), noise = random.uniform(0.1, 1.0);
    std::vector<float> x(3072);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] =
          static_cast<float>(std::cos(turn * f * static_cast<double>(i) / 10240.0 + phase) + noise * random.normal());
    }
    ring.push(x);
    const FrequencyEstimate found = ring.estimate(f + random.uniform(-10.0, 10.0), 20.0, 0.2);
    const double z = (found.frequency_hz - f) / found.std_hz;
    within += std::abs(z) < 2.0 ? 1 : 0;
    squares += z * z / runs;
    EXPECT_NEAR(found.amplitude, 1.0, 0.2);
  }
  EXPECT_GT(within, 0.9 * runs);
  EXPECT_GT(squares, 1.0 / 9.0);
}

TEST(CombCusum, DetectsATonesGrowthOnceAndItsEnd) {
  for (const auto& [teeth, rotation, chatter] : {std::tuple{3, 80.0, 683.0}, std::tuple{2, 133.0, 1210.0}}) {
    const SyntheticCut cut{
        .rotation_hz = rotation, .teeth = teeth, .channels = 2, .chatter_hz = chatter, .ends_s = 3.2, .seconds = 5.0};
    const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
    // A tenth of the final amplitude at 2 + ln(100)/30 s.
    const double alarm = first_alarm_s(decisions);
    EXPECT_GT(alarm, 2.0);
    EXPECT_LT(alarm, 2.0 + std::log(100.0) / 30.0 + 0.1);
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

TEST(CombCusum, StaysQuietInAStableCut) {
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
TEST(CombCusum, FollowsSpeedsAtMultiplesOfTheMains) {
  for (const double rotation_hz : {100.0, 150.0, 239.7, 240.0}) {
    const SyntheticCut cut{.rotation_hz = rotation_hz, .channels = 2, .seconds = 2.0};
    const double last = decisions_of(options_for(cut), vibration(cut)).back().spindle_speed_rad_per_s;
    EXPECT_NEAR(last, turn * rotation_hz, 1e-3 * turn * rotation_hz);
  }
}

// By less than 0.3 % in the looks that are compared: the slope shows it.
TEST(SpindleTracker, MovesWhileTheSpeedDrifts) {
  const SyntheticCut cut{.rotation_hz = 43.0, .drift_hz_per_s = -0.6, .noise = 0.03};
  const MonitorOptions options = options_for(cut);
  const std::vector<float> x = vibration(cut);
  SpindleTracker tracker(options);
  int moves = 0, still = 0;
  for (std::size_t at = 0; at + options.hop_samples() <= x.size(); at += options.hop_samples()) {
    tracker.step(std::span(x).subspan(at, options.hop_samples()), std::nullopt, false);
    const double t = static_cast<double>(at) / cut.sample_rate_hz;
    if (t > 2.4 && t < 2.9) moves += tracker.settled() ? 0 : 1;
    if ((t > 1.5 && t < 2.0) || t > 3.5) still += tracker.settled() ? 1 : 0;
  }
  EXPECT_GE(moves, 16);
  EXPECT_GE(still, 36);
}

TEST(CombCusum, StaysQuietWhileTheSpeedDrifts) {
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
TEST(CombCusum, KnowsTheSpeedFollowedLastWhileTheHintTrembles) {
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
TEST(CombCusum, FollowsTheSpeedInLongHops) {
  const SyntheticCut cut{.seconds = 8.0};
  MonitorOptions options = options_for(cut);
  options.hop_s = 0.6;
  options.window_s = 0.6;
  for (const Decision& d : decisions_of(options, vibration(cut)))
    EXPECT_NEAR(d.spindle_speed_rad_per_s, turn * 80.0, 2e-3 * turn * 80.0) << d.hop;
}

TEST(CombCusum, FollowsATachometer) {
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
  EXPECT_LT(alarm, 2.3);
  EXPECT_EQ(decisions.back().channel, 0);
}

TEST(CombCusum, SuggestsTheSampleRateThatFitsTheComb) {
  const SyntheticCut cut{.sample_rate_hz = 8000.0, .seconds = 6.0};
  MonitorOptions options = options_for(cut, 0.0);
  options.sample_rate_hz = 10240.0;
  const Decision last = decisions_of(options, vibration(cut)).back();
  EXPECT_TRUE(last.faults & wrong_sample_rate);
  EXPECT_NEAR(last.suggested_sample_rate_hz, 8000.0, 10.0);
  for (const Decision& d : decisions_of(options_for(cut), vibration(cut))) EXPECT_FALSE(d.faults & wrong_sample_rate);
}

// Growth so slow that the comb takes it off: the harmonic's amplitude against what was learnt of it shows it.
TEST(CombCusum, DetectsSynchronousChatter) {
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
