// What the cuts with the traits of recordings say of themselves is so. Seeds 1 to 20 of each class.
#include "testing/monitor/machine_cuts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "robomill/signal/spectrum.hpp"
#include "testing/monitor/corpus.hpp"
#include "testing/monitor/score.hpp"
#include "testing/support.hpp"

namespace robomill::monitor::testing {
namespace machine_cuts_test {

using std::numbers::pi;

/// Every class has 20 seeds for tests; a tenth of them without ROBOMILL_FULL, two at least.
std::uint64_t last_seed() {
  return static_cast<std::uint64_t>(std::max(2, test::seeds(20)));
}

/// Strongest line of a channel between two times [Hz].
double strongest_hz(const std::vector<float>& samples, int channels, int channel, double rate_hz, double from_s,
                    double to_s) {
  const auto from = static_cast<std::size_t>(from_s * rate_hz), to = static_cast<std::size_t>(to_s * rate_hz);
  Eigen::VectorXd x(static_cast<Eigen::Index>(to - from));
  for (std::size_t i = from; i < to; ++i) {
    x(static_cast<Eigen::Index>(i - from)) =
        static_cast<double>(samples[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)]);
  }
  const auto peaks = signal::find_peaks(signal::amplitude_spectrum(x, rate_hz), {.count = 1, .min_frequency_hz = 5.0});
  return peaks.empty() ? 0.0 : peaks.front().frequency_hz;
}

TEST(MachineCuts, AreWholeInEveryClass) {
  for (const auto& [name, kind] : machine_class_names) {
    int exact = 0, cuts = 0;
    for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
      const MachineCut c = draw_machine_cut(kind, seed);
      const RecordedCut& r = c.recorded;
      EXPECT_EQ(r.kind, name);
      EXPECT_EQ(r.truth.chatter, kind != MachineClass::air && seed % 2 == 1) << name << seed;
      const std::size_t frames = r.samples.size() / static_cast<std::size_t>(r.channels);
      EXPECT_EQ(r.truth.amplitude_m_per_s2.size(), frames) << name << seed;
      EXPECT_EQ(r.truth.speed_rad_per_s.size(), frames) << name << seed;
      EXPECT_TRUE(std::ranges::all_of(r.samples, [](float v) { return std::isfinite(v); }));
      EXPECT_GE(r.teeth, 2);
      const double nominal = static_cast<double>(*std::ranges::max_element(r.truth.speed_rad_per_s));
      EXPECT_LT(std::abs(r.hint_rad_per_s / nominal - 1.0), 0.25) << name << seed;  // speeds change in the cut, too
      exact += r.truth.speed_rad_per_s.front() == static_cast<float>(r.hint_rad_per_s) ? 1 : 0;
      ++cuts;
      if (!r.truth.chatter) continue;
      EXPECT_LE(c.entry_s, r.truth.start_s + 0.02) << name << seed;
      EXPECT_LE(r.truth.start_s, r.truth.t10_s) << name << seed;
      EXPECT_LT(r.truth.t10_s + 0.3, r.truth.end_s) << name << seed;
      EXPECT_LE(r.truth.end_s, r.seconds() + 1e-3) << name << seed;
      EXPECT_FALSE(r.truth.lines_hz.empty());
      for (const double line : r.truth.lines_hz) EXPECT_LE(line, 0.5 * r.sample_rate_hz);
    }
    EXPECT_LT(exact, cuts) << name;
  }
}

TEST(MachineCuts, ASeedIsACut) {
  for (const auto& [name, kind] : machine_class_names) {
    const RecordedCut one = machine_cut(kind, 2);
    EXPECT_EQ(one.samples, machine_cut(kind, 2).samples) << name;
    EXPECT_NE(one.samples, machine_cut(kind, 1002).samples) << name;
  }
}

TEST(MachineCuts, AbruptChatterIsFullATenthOfASecondAfterEntry) {
  for (std::uint64_t seed = 1; seed <= last_seed(); seed += 2) {
    const MachineCut c = draw_machine_cut(MachineClass::abrupt, seed);
    const Truth& t = c.recorded.truth;
    const auto from = static_cast<std::ptrdiff_t>(c.entry_s * corpus_rate_hz);
    const auto first = std::ranges::find_if(t.amplitude_m_per_s2.begin() + from, t.amplitude_m_per_s2.end(),
                                            [&](float a) { return a >= 0.9 * t.final_m_per_s2; });
    const double full_s = static_cast<double>(first - t.amplitude_m_per_s2.begin()) / corpus_rate_hz;
    EXPECT_LE(full_s, c.entry_s + 0.1) << seed;
  }
}

// By the signal: its instantaneous frequency, from the phase that two windows a few milliseconds apart show, moves as
// the truth says.
TEST(MachineCuts, DriftingChatterIsWhereItsCourseSays) {
  for (std::uint64_t seed = 1; seed <= last_seed(); seed += 2) {
    const MachineCut c = draw_machine_cut(MachineClass::drifting, seed);
    const Truth& t = c.recorded.truth;
    const auto at = [&](double time_s) {
      return static_cast<double>(t.course_hz[static_cast<std::size_t>(time_s * corpus_rate_hz)]);
    };
    const double moved = std::abs(at(t.end_s - 0.05) - at(t.start_s));
    EXPECT_GT(moved, 5.0) << seed;
    EXPECT_LT(moved, 420.0) << seed;
    const CleanCut::Columns chatter = c.clean.acceleration_m_per_s2 - c.clean.forced_m_per_s2;
    std::vector<float> x;
    for (Eigen::Index i = 0; i < chatter.rows(); ++i) {
      x.push_back(static_cast<float>(chatter(i, 0)));
      x.push_back(static_cast<float>(chatter(i, 1)));
    }
    const double middle_s = t.end_s - 0.2;
    double nearest = 1e9;
    for (int channel = 0; channel < 2; ++channel) {
      const double line = strongest_hz(x, 2, channel, corpus_rate_hz, middle_s - 0.05, middle_s + 0.05);
      nearest = std::min(nearest, std::abs(line - at(middle_s)));
    }
    EXPECT_LT(nearest, 12.0) << seed;
  }
}

TEST(MachineCuts, HoppingChatterVisitsTwoModesAtLeast) {
  for (std::uint64_t seed = 1; seed <= last_seed(); seed += 2) {
    const Truth t = machine_cut(MachineClass::hopping, seed).truth;
    int hops = 0;
    for (std::size_t i = 1; i < t.course_hz.size(); ++i) {
      hops += std::abs(t.course_hz[i] - t.course_hz[i - 1]) > 10.0F ? 1 : 0;
    }
    EXPECT_GE(hops, 1) << seed;
  }
}

TEST(MachineCuts, AliasesAreWhereTheArithmeticSays) {
  EXPECT_DOUBLE_EQ(folded_hz(700.0, 1650.0), 700.0);
  EXPECT_DOUBLE_EQ(folded_hz(900.0, 1650.0), 750.0);
  EXPECT_DOUBLE_EQ(folded_hz(1650.0, 1650.0), 0.0);
  EXPECT_DOUBLE_EQ(folded_hz(2500.0, 1650.0), 800.0);
  int folded = 0;
  for (std::uint64_t seed = 1; seed <= 9; seed += 2) {
    const MachineCut c = draw_machine_cut(MachineClass::aliased, seed);
    EXPECT_EQ(c.recorded.channels, 3);
    EXPECT_EQ(c.recorded.sample_rate_hz, aliased_rate_hz);
    const Truth& t = c.recorded.truth;
    EXPECT_DOUBLE_EQ(t.frequency_hz, folded_hz(c.at_corpus_rate.frequency_hz, aliased_rate_hz));
    folded += c.at_corpus_rate.frequency_hz > 0.5 * aliased_rate_hz ? 1 : 0;
    // What chatters, taken every 1/1650 s: its strongest line in one channel or the other.
    const CleanCut::Columns chatter = c.recorded.course == "model"
                                          ? c.clean.acceleration_m_per_s2 - c.clean.forced_m_per_s2
                                          : chatter_of(c.plan, c.clean, c.at_corpus_rate);
    std::vector<float> x;
    for (double row = 0.0; row < static_cast<double>(chatter.rows() - 1); row += corpus_rate_hz / aliased_rate_hz) {
      const Eigen::RowVector2d value = at_row(chatter, row);
      x.push_back(static_cast<float>(value(0)));
      x.push_back(static_cast<float>(value(1)));
    }
    double nearest = 1e9;
    for (int channel = 0; channel < 2; ++channel) {
      const double line = strongest_hz(x, 2, channel, aliased_rate_hz, t.t10_s, t.end_s);
      for (const double known : t.lines_hz) nearest = std::min(nearest, std::abs(line - known));
    }
    EXPECT_LT(nearest, 4.0) << seed;
  }
  EXPECT_GE(folded, 2);
}

TEST(MachineCuts, MicrophonesHave16BitsAtARateOfSound) {
  for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
    const RecordedCut r = machine_cut(MachineClass::microphone, seed);
    EXPECT_TRUE(r.sample_rate_hz == 44100.0 || r.sample_rate_hz == 48000.0);
    EXPECT_LE(r.channels, 2);
    for (std::size_t i = 0; i < 2000; ++i) {
      EXPECT_EQ(r.samples[i] * 32768.0F, std::round(r.samples[i] * 32768.0F));
      EXPECT_LT(std::abs(r.samples[i]), 1.0F);
    }
  }
}

TEST(MachineCuts, RunUpStartsAndEndsAtStandstillAndCutsAtSpeed) {
  for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
    const MachineCut c = draw_machine_cut(MachineClass::run_up_down, seed);
    const std::vector<float>& speed = c.recorded.truth.speed_rad_per_s;
    EXPECT_EQ(speed.front(), 0.0F);
    EXPECT_EQ(speed.back(), 0.0F);
    EXPECT_GT(c.entry_s, 0.8);
    for (std::size_t i = 0; i < speed.size(); ++i) {
      if (c.clean.depth_share[i] > 0.0F) {
        ASSERT_GT(static_cast<double>(speed[i]), 0.8 * c.plan.speed_rad_per_s()) << seed;
      }
    }
  }
}

TEST(MachineCuts, AirNeverCuts) {
  for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
    const MachineCut c = draw_machine_cut(MachineClass::air, seed);
    EXPECT_FALSE(c.recorded.truth.chatter);
    EXPECT_EQ(c.clean.acceleration_m_per_s2.norm(), 0.0);
    EXPECT_TRUE(std::ranges::all_of(c.recorded.truth.amplitude_m_per_s2, [](float a) { return a == 0.0F; }));
    EXPECT_TRUE(std::ranges::any_of(c.recorded.samples, [](float v) { return v != 0.0F; }));
  }
}

// As many pulses as the spindle's angle has; what is between two of them is a whole number of samples.
TEST(MachineCuts, PulsesCountTheRevolutions) {
  std::set<int> counts;
  std::set<bool> first_levels;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    if (seed > last_seed() && seed != 3) continue;  // 3: 1,024 a revolution
    const MachineCut c = draw_machine_cut(MachineClass::pulses, seed);
    const RecordedCut& r = c.recorded;
    ASSERT_EQ(r.tachometer_channel, 2);
    ASSERT_EQ(r.channels, 3);
    counts.insert(r.pulses_per_revolution);
    double turns = 0.0;
    int edges = 0;
    bool before = true;
    for (std::size_t i = 0; i < r.samples.size() / 3; ++i) {
      const bool high = r.samples[3 * i + 2] > 2.5F;
      edges += high && !before ? 1 : 0;
      before = high;
      turns += static_cast<double>(r.truth.speed_rad_per_s[i]) / (2.0 * pi * r.sample_rate_hz);
    }
    EXPECT_EQ(edges, c.upward_edges);
    EXPECT_NEAR(edges, turns * r.pulses_per_revolution, 1.5) << seed;
    const RecordedCut without = without_tachometer(r);
    EXPECT_EQ(without.channels, 2);
    EXPECT_EQ(without.tachometer_channel, -1);
    EXPECT_EQ(without.samples[2 * 77], r.samples[3 * 77]);
    EXPECT_EQ(without.samples[2 * 77 + 1], r.samples[3 * 77 + 1]);
  }
  EXPECT_TRUE(counts.contains(1));
  EXPECT_TRUE(counts.contains(1024));
}

// Source: [ClopperPearson1934]: none of n gives 1 - 0.025^(1/n), and an interval covers the rate it is drawn from.
TEST(Score, RateIntervalsCover) {
  EXPECT_EQ(rate_interval(0, 10).low, 0.0);
  EXPECT_NEAR(rate_interval(0, 10).high, 1.0 - std::pow(0.025, 0.1), 1e-12);
  EXPECT_NEAR(rate_interval(10, 10).low, std::pow(0.025, 0.1), 1e-12);
  EXPECT_EQ(rate_interval(10, 10).high, 1.0);
  EXPECT_NEAR(rate_interval(94, 100).low, 0.8740, 5e-5);
  EXPECT_NEAR(rate_interval(94, 100).high, 0.9777, 5e-5);
  EXPECT_EQ(rate_interval(0, 0).high, 1.0);
  Random random(8);
  int covered = 0;
  for (int k = 0; k < 2000; ++k) {
    int events = 0;
    for (int i = 0; i < 40; ++i) events += random.uniform() < 0.2 ? 1 : 0;
    const RateInterval interval = rate_interval(events, 40);
    covered += interval.low <= 0.2 && 0.2 <= interval.high ? 1 : 0;
  }
  EXPECT_GE(covered, 1880);  // 95 % at least, less four standard deviations
}

TEST(Score, AMovingLineIsComparedWithWhereItWas) {
  RecordedCut c;
  c.samples.assign(2 * 20480, 0.0F);
  c.truth = {.chatter = true, .start_s = 0.5, .t10_s = 0.5, .end_s = 2.0, .final_m_per_s2 = 1.0, .frequency_hz = 500.0};
  c.truth.lines_hz = {500.0, 600.0};
  c.truth.amplitude_m_per_s2.assign(20480, 1.0F);
  for (int i = 0; i < 20480; ++i) c.truth.course_hz.push_back(500.0F + static_cast<float>(i) / 102.4F);  // 100 Hz/s
  const std::vector<DetectorDecision> one = {{.time_s = 1.5, .chatter = true, .stable = false, .frequency_hz = 640.0}};
  // From 1.3 to 1.5 s at 630 to 650 Hz, and 100 Hz above that.
  EXPECT_LT(score(c, one).frequency_error_hz, 0.6);
  const std::vector<DetectorDecision> late = {{.time_s = 1.5, .chatter = true, .stable = false, .frequency_hz = 620.0}};
  EXPECT_NEAR(score(c, late).frequency_error_hz, 10.0, 0.2);
}

}  // namespace machine_cuts_test
}  // namespace robomill::monitor::testing
