// The test of orders on cuts that are known to the last term.
#include "robomill/monitor/orders/cut_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace cut_tests_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

constexpr double turn = 2.0 * std::numbers::pi;
constexpr double hop_s = 0.025;
// What grows by 30/s from 1e-3 is a third of tooth passing after so long.
const double to_a_third_s = std::log(1000.0 / 3.0) / 30.0;

struct Detected {
  double alarm_s = -1.0;  // the first
  double over_s = -1.0;   // the last hop of chatter
  std::vector<CutTests::Verdict> verdicts;
};

Detected detect(const SyntheticCut& cut, const std::vector<float>& x, double hint_off = 0.0) {
  const auto channels = static_cast<std::size_t>(cut.channels);
  CutTests test({.sample_rate_hz = cut.sample_rate_hz, .hop_s = hop_s, .channels = channels, .teeth = cut.teeth});
  test.set_hint(cut.rotation_hz * (1.0 + hint_off));
  const auto frames = static_cast<std::size_t>(std::lround(hop_s * cut.sample_rate_hz));
  std::vector<float> hop(frames * channels);
  Detected out;
  for (std::size_t at = 0; (at + frames) * channels <= x.size(); at += frames) {
    for (std::size_t c = 0; c < channels; ++c) {
      for (std::size_t i = 0; i < frames; ++i) hop[c * frames + i] = x[(at + i) * channels + c];
    }
    out.verdicts.push_back(test.step(hop, frames, 0));
    if (!out.verdicts.back().chatter) continue;
    out.over_s = static_cast<double>(at + frames) / cut.sample_rate_hz;
    if (out.alarm_s < 0.0) out.alarm_s = out.over_s;
  }
  return out;
}

/// Adds what a function of the time [s] gives, to all channels.
template <class F>
std::vector<float> with(const SyntheticCut& cut, F&& more) {
  std::vector<float> x = vibration(cut);
  const auto channels = static_cast<std::size_t>(cut.channels);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += static_cast<float>(more(static_cast<double>(i / channels) / cut.sample_rate_hz));
  }
  return x;
}

/// The tool cuts from a time to another; air, a hundredth of noise, beside it. Entry and exit last 50 ms.
std::vector<float> within(const SyntheticCut& cut, double from_s, double to_s) {
  std::vector<float> x = vibration(cut);
  Random random(77);
  const auto channels = static_cast<std::size_t>(cut.channels);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i / channels) / cut.sample_rate_hz;
    const double in = std::clamp(std::min(t - from_s, to_s - t) / 0.05, 0.0, 1.0);
    x[i] = static_cast<float>(in * x[i] + 0.01 * random.normal());
  }
  return x;
}

TEST(CutTests, FindsChatterSoonWhateverTheHint) {
  Random random(1);
  for (const double hint_off : {0.0, 0.03, -0.03}) {
    for (int run = 0; run < 5; ++run) {
      SyntheticCut cut{.rotation_hz = random.uniform(62.0, 150.0), .teeth = 2 + run % 3, .seconds = 3.0};
      cut.seed = static_cast<std::uint64_t>(run) + 1;
      cut.channels = 1 + run % 2;
      cut.chatter_hz = (std::floor(random.uniform(4.0, 14.0)) + random.uniform(0.2, 0.8)) * cut.rotation_hz;
      const Detected detected = detect(cut, vibration(cut), hint_off);
      EXPECT_GT(detected.alarm_s, 2.0 + to_a_third_s - 0.05) << cut.rotation_hz << " " << cut.chatter_hz;
      EXPECT_LT(detected.alarm_s, 2.0 + to_a_third_s + 0.2) << cut.rotation_hz << " " << cut.chatter_hz;
      for (std::size_t k = 0; k < detected.verdicts.size(); ++k) {
        const CutTests::Verdict& v = detected.verdicts[k];
        const double t = static_cast<double>(k + 1) * hop_s;
        EXPECT_EQ(v.chatter, detected.alarm_s > 0.0 && t > detected.alarm_s - 1e-6) << t;  // without a break
        if (t > 0.6) {
          EXPECT_TRUE(v.known) << t;
          EXPECT_NEAR(v.rotation_hz, cut.rotation_hz, 2e-3 * cut.rotation_hz) << t;
        }
        if (!v.chatter) continue;
        EXPECT_NEAR(v.frequency_hz, cut.chatter_hz, 3.0) << t;
        EXPECT_LT(v.frequency_std_hz, 2.0);
        EXPECT_EQ(v.channel, 0U);
        EXPECT_EQ(v.synchronous, SynchronousChatter::none);
        if (t > detected.alarm_s + 0.15) {
          EXPECT_NEAR(v.frequency_hz, cut.chatter_hz, std::min(1.0, 3.0 * v.frequency_std_hz)) << t;
        }
      }
    }
  }
}

// At a best speed a harmonic of the teeth meets the tool's mode and holds nearly all energy: the 16th order here, in a
// cut of a thousandth of the energy of the one before.
TEST(CutTests, AHarmonicThatMeetsAModeIsNoChatter) {
  for (const int teeth : {0, 2}) {
    for (const double hint_off : {0.0, 0.02, -0.02}) {
      SyntheticCut cut{.rotation_hz = 33.83, .teeth = 2, .noise = 0.02, .seconds = 5.0};
      std::vector<float> x = with(cut, [&](double t) { return 4.0 * std::cos(16.0 * turn * cut.rotation_hz * t); });
      Random random(8);
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double t = static_cast<double>(i) / cut.sample_rate_hz;
        const double in = std::clamp(std::min(t - 0.5, 2.0 - t) / 0.05, 0.0, 1.0) * 30.0;
        x[i] = static_cast<float>((in + std::clamp((t - 2.5) / 0.05, 0.0, 1.0)) * x[i] + 0.02 * random.normal());
      }
      cut.teeth = teeth;
      EXPECT_EQ(detect(cut, x, hint_off).alarm_s, -1.0) << teeth << " " << hint_off;
    }
  }
}

// High orders move by more than a line is wide before the speed is seen to move.
TEST(CutTests, IsQuietWhereTheSpeedMovesUnderHighOrders) {
  for (const double rotation_hz : {107.0, 117.0, 126.0}) {
    for (const double drift : {-0.04, -0.02, -0.01, 0.01, 0.02, 0.04}) {
      const SyntheticCut cut{
          .rotation_hz = rotation_hz, .drift_hz_per_s = drift * rotation_hz, .noise = 0.02, .seconds = 3.5};
      const std::vector<float> x = with(cut, [&](double t) {
        const double drifting = std::clamp(t - 2.0, 0.0, 1.0), drifted = std::max(t - 3.0, 0.0);
        const double turns = rotation_hz * t + cut.drift_hz_per_s * (0.5 * drifting * drifting + drifted);
        double sum = 0.0;
        for (int j = 7; j <= 12; ++j) sum += 0.4 * std::cos(j * turn * cut.teeth * turns);
        return sum;
      });
      EXPECT_EQ(detect(cut, x).alarm_s, -1.0) << rotation_hz << " " << drift;
    }
  }
}

// L/S = A²/(Σ 1/j² + 0.01), j to 6.
TEST(CutTests, ReportsTheRatioOfTheEnergies) {
  for (const double amplitude : {0.7, 1.0, 2.0}) {
    const SyntheticCut cut{.noise = 0.02, .chatter_hz = 683.0, .chatter = amplitude, .seconds = 3.5};
    const double ratio = amplitude * amplitude / 1.5014;
    const Detected detected = detect(cut, vibration(cut));
    EXPECT_NEAR(detected.verdicts.back().score, 1.0 + ratio, 0.06 * ratio);
  }
}

TEST(CutTests, IsOverWhenTheChatterIs) {
  const SyntheticCut cut{.chatter_hz = 683.0, .ends_s = 2.7, .seconds = 4.5};
  const Detected detected = detect(cut, vibration(cut));
  EXPECT_GT(detected.alarm_s, 2.0);
  EXPECT_GT(detected.over_s, 2.7);
  EXPECT_LT(detected.over_s, 3.2);
}

TEST(CutTests, IsQuietInStableCutsAndWhileTheSpeedDrifts) {
  Random random(2);
  for (int run = 0; run < 9; ++run) {
    SyntheticCut cut{.rotation_hz = random.uniform(45.0, 180.0), .teeth = 1 + run % 4, .noise = 0.05 * (1 + run % 4)};
    cut.seed = static_cast<std::uint64_t>(run) + 1;
    cut.drift_hz_per_s = run % 3 == 0 ? 0.0 : random.uniform(-0.05, 0.05) * cut.rotation_hz;
    EXPECT_EQ(detect(cut, vibration(cut), random.uniform(-0.03, 0.03)).alarm_s, -1.0)
        << cut.rotation_hz << " " << cut.drift_hz_per_s;
  }
}

TEST(CutTests, IsQuietWhereSomethingKnocks) {
  for (const double hz : {417.0, 1310.0, 2777.0}) {
    for (const double height : {1.0, 10.0}) {
      const SyntheticCut cut{.seconds = 3.2};
      const std::vector<float> x = with(cut, [&](double t) {
        double sum = 0.0;
        for (const double at : {1.013, 2.0, 2.311, 2.907}) {
          if (t > at) sum += height * std::exp((at - t) / 0.02) * std::sin(turn * hz * (t - at));
        }
        return sum;
      });
      EXPECT_EQ(detect(cut, x).alarm_s, -1.0) << hz << " " << height;
    }
  }
}

// Two within a window, on a mode that rings in the cut: one pair in twenty passes for chatter at most.
TEST(CutTests, IsQuietWherePairsOfKnocksFollow) {
  Random random(5);
  const int runs = test::seeds(100);
  int alarms = 0;
  for (int run = 0; run < runs; ++run) {
    const SyntheticCut cut{.seconds = 3.0};
    const double hz = random.uniform(500.0, 700.0), first_s = random.uniform(1.0, 1.1);
    const double second_s = first_s + random.uniform(0.08, 0.25), height = random.uniform(3.0, 10.0);
    const std::vector<float> x = with(cut, [&](double t) {
      double sum = 0.3 * std::cos(turn * hz * t);
      for (const double at : {first_s, second_s}) {
        if (t > at) sum += height * std::exp((at - t) / 0.03) * std::sin(turn * hz * (t - at));
      }
      return sum;
    });
    alarms += detect(cut, x).alarm_s >= 0.0 ? 1 : 0;
  }
  EXPECT_LE(alarms, std::max(1, runs / 20));
}

// A spindle that runs to another speed within some tenths of a second: its orders stand beside those of the speed
// before, and one that meets a mode grows and is the strongest line.
TEST(CutTests, IsQuietWhileTheSpindleRunsToAnotherSpeed) {
  Random random(6);
  for (int run = 0; run < test::seeds(60); ++run) {
    const int teeth = 2 + run % 3;
    const double before_hz = random.uniform(40.0, 160.0), after_hz = before_hz * random.uniform(0.9, 1.1);
    const double runs_s = random.uniform(0.1, 0.6), mode_hz = 2.0 * teeth * after_hz;
    SyntheticCut still{.teeth = teeth, .seconds = 3.5};
    Random noise(static_cast<std::uint64_t>(run) + 1);
    std::vector<float> x;
    double angle = 0.0;
    for (double t = 0.0; t < still.seconds; t += 1.0 / still.sample_rate_hz) {
      const double hz = before_hz + (after_hz - before_hz) * std::clamp((t - 1.5) / runs_s, 0.0, 1.0);
      angle += turn * hz / still.sample_rate_hz;
      double sum = 0.1 * std::cos(angle) + 0.1 * noise.normal();
      for (int j = 1; j <= 6; ++j) {
        const double off = (j * teeth * hz - mode_hz) / (0.02 * mode_hz);
        sum += std::cos(j * teeth * angle + 0.7) / j * (1.0 + 9.0 / (1.0 + off * off));
      }
      x.push_back(static_cast<float>(sum));
    }
    still.rotation_hz = before_hz;
    EXPECT_EQ(detect(still, x, random.uniform(-0.02, 0.02)).alarm_s, -1.0)
        << teeth << " " << before_hz << " " << after_hz << " " << runs_s;
  }
}

TEST(CutTests, IsQuietWhereTheToolEntersAndLeaves) {
  for (const double hint_off : {0.0, 0.03, -0.03}) {
    for (const double rotation_hz : {47.0, 133.0}) {
      const SyntheticCut cut{.rotation_hz = rotation_hz, .seconds = 3.4};
      EXPECT_EQ(detect(cut, within(cut, 1.0, 2.9), hint_off).alarm_s, -1.0) << rotation_hz << " " << hint_off;
      EXPECT_EQ(detect(cut, within(cut, -1.0, 2.003), hint_off).alarm_s, -1.0) << rotation_hz << " " << hint_off;
    }
  }
}

TEST(CutTests, FindsChatterThatStartsWithTheRecordingOrTheCut) {
  for (const double hint_off : {0.0, 0.03, -0.03}) {
    const SyntheticCut cut{.chatter_hz = 683.0, .starts_s = -1.0, .seconds = 3.0};
    const Detected first = detect(cut, vibration(cut), hint_off);
    EXPECT_GT(first.alarm_s, 0.0);
    EXPECT_LT(first.alarm_s, 0.7);
    const Detected second = detect(cut, within(cut, 1.0, 10.0), hint_off);
    EXPECT_GT(second.alarm_s, 1.0);
    EXPECT_LT(second.alarm_s, 1.75) << hint_off;
    EXPECT_NEAR(second.verdicts.back().frequency_hz, 683.0, 1.0);
  }
}

// No speed is given, and the spindle turns faster in chatter that goes on.
TEST(CutTests, FindsTheCombAnewInChatter) {
  constexpr double no_hint = -1.0;
  const SyntheticCut slow{.rotation_hz = 83.0, .chatter_hz = 683.0, .seconds = 3.5};
  SyntheticCut fast = slow;
  fast.rotation_hz = 120.0;
  fast.starts_s = -1.0;
  std::vector<float> x = vibration(slow);
  const std::vector<float> then = vibration(fast);
  x.insert(x.end(), then.begin(), then.end());
  const Detected detected = detect(slow, x, no_hint);
  for (std::size_t hop = 120; hop < detected.verdicts.size(); ++hop) {
    const double t = static_cast<double>(hop + 1) * hop_s;
    const CutTests::Verdict& verdict = detected.verdicts[hop];
    EXPECT_TRUE(verdict.chatter) << t;
    EXPECT_TRUE(verdict.known || (t > 3.5 && t < 4.3)) << t;
  }
}

// Another tone as loud is.
TEST(CutTests, HumIsNoChatter) {
  const SyntheticCut cut{.rotation_hz = 83.0, .seconds = 2.0};
  for (const double hz : {50.0, 100.0, 107.0, 120.0, 150.0, 180.0}) {
    const auto tone = [&](double t) { return std::cos(turn * hz * t); };
    EXPECT_EQ(detect(cut, with(cut, tone)).alarm_s > 0.0, hz == 107.0) << hz;
  }
}

TEST(CutTests, NamesSynchronousChatterByItsOrder) {
  using enum SynchronousChatter;
  for (const auto& [teeth, order, kind] :
       {std::tuple{3, 7.0, locked}, std::tuple{2, 7.0, period_doubling}, std::tuple{4, 6.0, period_doubling},
        std::tuple{4, 9.0, locked}, std::tuple{3, 7.5, none}, std::tuple{2, 6.4, none}}) {
    const SyntheticCut cut{.teeth = teeth, .chatter_hz = 80.0 * order, .chatter = 3.0, .seconds = 3.0};
    const Detected detected = detect(cut, vibration(cut));
    EXPECT_GT(detected.alarm_s, 2.0) << teeth << " " << order;
    EXPECT_LT(detected.alarm_s, 2.0 + to_a_third_s + 0.2) << teeth << " " << order;
    EXPECT_EQ(detected.verdicts.back().synchronous, kind) << teeth << " " << order;
    EXPECT_NEAR(detected.verdicts.back().frequency_hz, cut.chatter_hz, 1.5);
  }
}

TEST(CutTests, StaysFiniteWithAnyInput) {
  static_assert(noexcept(std::declval<CutTests&>().step({}, 0, 0)));
  for (const double rate_hz : {100.0, 10240.0, 44100.0, 1e6}) {
    for (const double any_hop_s : {0.16, 0.6}) {
      for (const double amplitude : {0.0, 1e14}) {
        for (const std::size_t channels : {1U, 64U}) {
          if (channels == 64 && (rate_hz > 20000.0 || any_hop_s < 0.5)) continue;
          CutTests test({.sample_rate_hz = rate_hz, .hop_s = any_hop_s, .channels = channels, .teeth = 3});
          const auto frames = static_cast<std::size_t>(any_hop_s * rate_hz);
          std::vector<float> hop(frames * channels);
          for (int k = 0; k < 6; ++k) {
            for (std::size_t i = 0; i < hop.size(); ++i) {
              const double t = static_cast<double>(i % frames) / rate_hz + k * any_hop_s;
              hop[i] = static_cast<float>(amplitude * std::sin(turn * 20.0 * t));
            }
            test.set_hint(k % 3 == 0 ? 0.0 : 20.0);
            if (k == 4) test.measured(20.0, 1e-3);
            const std::uint64_t bad = k == 2 ? ~std::uint64_t{0} : k == 3 ? 1U : 0U;
            const CutTests::Verdict v = test.step(hop, frames, bad);
            for (const double x : {v.frequency_hz, v.frequency_std_hz, v.score, v.rotation_hz, v.rotation_std_ratio}) {
              EXPECT_FALSE(std::isnan(x)) << rate_hz << " " << any_hop_s << " " << amplitude << " " << k;
            }
            EXPECT_FALSE(v.chatter);
            EXPECT_LT(v.channel, channels);
          }
        }
      }
    }
  }
}

TEST(CutTests, DecidesTheSameAfterReset) {
  const SyntheticCut cut{.chatter_hz = 683.0, .seconds = 2.6};
  const std::vector<float> x = vibration(cut);
  CutTests test({.sample_rate_hz = cut.sample_rate_hz, .hop_s = hop_s, .teeth = cut.teeth});
  test.set_hint(81.0);
  std::vector<CutTests::Verdict> first;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t at = 0, k = 0; at + 256 <= x.size(); at += 256, ++k) {
      const CutTests::Verdict v = test.step(std::span(x).subspan(at, 256), 256, 0);
      if (pass == 0) {
        first.push_back(v);
        continue;
      }
      ASSERT_EQ(v.chatter, first[k].chatter) << k;
      ASSERT_EQ(v.rotation_hz, first[k].rotation_hz) << k;
      ASSERT_EQ(v.score, first[k].score) << k;
      ASSERT_EQ(v.frequency_hz, first[k].frequency_hz) << k;
    }
    test.reset();
  }
  EXPECT_TRUE(first.back().chatter);
}

// Linear, and as half a cosine, in 10 to 500 ms, over an idling spindle whose lines are those of the cut.
TEST(CutTests, AnEntryIsNoChatterHoweverSlowly) {
  for (const double idle : {0.0, 0.01, 0.03, 0.1}) {
    for (const bool linear : {false, true}) {
      Random random(3);
      const int runs = test::seeds(30);
      for (int run = 0; run < runs; ++run) {
        SyntheticCut cut{.rotation_hz = random.uniform(60.0, 200.0), .teeth = 2 + run % 3, .noise = 0.0};
        const double lasts_s = random.uniform(0.01, 0.5);
        std::vector<float> x = vibration(cut);
        for (std::size_t i = 0; i < x.size(); ++i) {
          const double in = std::clamp((static_cast<double>(i) / cut.sample_rate_hz - 1.5) / lasts_s, 0.0, 1.0);
          const double level = linear ? in : 0.5 - 0.5 * std::cos(0.5 * turn * in);
          x[i] =
              static_cast<float>(static_cast<double>(x[i]) * (idle + (1.0 - idle) * level) + 0.002 * random.normal());
        }
        EXPECT_EQ(detect(cut, x, 0.01).alarm_s, -1.0) << idle << " " << cut.rotation_hz << " " << lasts_s;
      }
    }
  }
}

}  // namespace cut_tests_test
