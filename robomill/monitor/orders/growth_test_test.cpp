// The test of a cut against its past, on energies that are given.
#include "robomill/monitor/orders/growth_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace growth_test_test {

using namespace robomill;
using robomill::monitor::FamilyGrowth;
using robomill::monitor::GrowthTest;

constexpr double hop_s = 0.025;
constexpr std::size_t place = 67;  // 670 to 680 Hz

/// A cut whose line at `place` holds a tenth of the synchronous energy, over noise that hardly counts.
struct Past {
  explicit Past(int hops = 60) { listen(hops, 1.0, 0.1); }

  void listen(int hops, double synchronous, double line, std::size_t at = place) {
    for (int k = 0; k < hops; ++k) {
      step(synchronous, line, at);
      test.learn();
    }
  }
  GrowthTest::Verdict step(double synchronous, double line, std::size_t at = place) {
    const auto cells = test.begin();
    for (double& cell : cells) cell = -1e-4 * std::log(1.0 - random.uniform()) * synchronous;
    cells[at] += line;
    return test.step(synchronous);
  }
  GrowthTest test = GrowthTest(5000.0, hop_s);
  Random random = Random(3);
};

TEST(GrowthTest, FindsALineThatHasGrownTenfold) {
  EXPECT_EQ(Past().step(1.0, 0.1).energy, 0.0);
  EXPECT_EQ(Past().step(1.0, 0.1 * std::pow(10.0, 0.5)).energy, 0.0);   // 5 dB
  EXPECT_EQ(Past().step(1.0, 0.1 * std::pow(10.0, 0.95)).energy, 0.0);  // 9.5 dB
  for (const double synchronous : {1.0, 0.8, 1.03}) {
    const GrowthTest::Verdict found = Past().step(synchronous, 0.1 * std::pow(10.0, 1.05));  // 10.5 dB
    EXPECT_NEAR(found.energy, 0.1 * std::pow(10.0, 1.05), 2e-3) << synchronous;
    EXPECT_EQ(found.frequency_hz, (place + 0.5) * GrowthTest::cell_hz);
  }
}

TEST(GrowthTest, FindsANewLineAnywhere) {
  Random random(1);
  const int runs = test::seeds(200);
  for (int run = 0; run < runs; ++run) {
    const std::size_t at = random.index(500);
    if (at + 5 > place && at < place + 5) continue;
    Past past;
    // What is weaker than a twentieth of the orders marks no part.
    EXPECT_EQ(past.step(1.0, 0.04, at).energy, 0.0) << at;
    const GrowthTest::Verdict found = past.step(1.0, 0.06, at);
    EXPECT_NEAR(found.energy, 0.06, 2e-3) << at;
    EXPECT_EQ(found.frequency_hz, (static_cast<double>(at) + 0.5) * GrowthTest::cell_hz);
  }
}

TEST(GrowthTest, ADeeperCutIsNoGrowth) {
  for (const double deeper : {3.0, 20.0, 1000.0}) {
    EXPECT_EQ(Past().step(deeper, deeper * 0.1).energy, 0.0) << deeper;
    EXPECT_EQ(Past().step(deeper, deeper * 0.9).energy, 0.0) << deeper;
    EXPECT_GT(Past().step(deeper, deeper * 1.1).energy, 0.0) << deeper;
  }
}

TEST(GrowthTest, JudgesNothingBeforeItHasAPast) {
  Past past(0);
  for (int k = 0; k < 16; ++k) {
    EXPECT_EQ(past.step(1.0, k == 8 ? 9.0 : 0.0).energy, 0.0) << k;
    past.test.learn();
  }
  EXPECT_GT(past.step(1.0, 9.0, 200).energy, 0.0);
  past.test.forget();
  EXPECT_EQ(past.step(1.0, 9.0, 200).energy, 0.0);
}

// The past takes a new level in within its memory of 1 s, but of 5 s what has grown by 5 dB.
TEST(GrowthTest, IsSlowToGetUsedToWhatGrows) {
  const auto after_a_second_at = [](double line) {
    Past past;
    past.listen(40, 1.0, line);
    // The level that is ten times the past.
    double low = 0.1, high = 10.0;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (past.step(1.0, middle).energy > 0.0 ? high : low) = middle;
    }
    return low / 10.0;
  };
  // x(t) = b + (a - b) exp(-t/τ) from a = 0.1
  EXPECT_NEAR(after_a_second_at(0.2), 0.2 - 0.1 * std::exp(-1.0), 0.008);
  EXPECT_NEAR(after_a_second_at(0.5), 0.5 - 0.4 * std::exp(-0.2), 0.02);
}

TEST(GrowthTest, LivesWithSilenceAndAnyHop) {
  for (const double any_hop_s : {0.001, 0.6, 3.0}) {
    GrowthTest test(120.0, any_hop_s);
    for (int k = 0; k < 50; ++k) {
      std::ranges::fill(test.begin(), 0.0);
      const GrowthTest::Verdict found = test.step(0.0);
      EXPECT_EQ(found.energy, 0.0);
      EXPECT_EQ(found.frequency_hz, 0.0);
      test.learn();
    }
  }
}

/// A family of energy 1 beside a cut of S = 10, for so long.
struct FamilyPast {
  explicit FamilyPast(double seconds = 5.0) { listen(seconds, 1.0); }
  void listen(double seconds, double family) {
    for (int k = 0; k < std::lround(seconds / hop_s); ++k) {
      (void)test.step({.synchronous = 10.0, .family = family}, 0.0, true);
    }
  }
  bool grown(double family, double synchronous = 10.0, double swing = 0.0) {
    return test.step({.synchronous = synchronous, .family = family}, swing, false);
  }
  /// Three times the past.
  double limit() {
    double low = 0.31, high = 300.0;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (grown(middle) ? high : low) = middle;
    }
    return low;
  }
  FamilyGrowth test = FamilyGrowth(hop_s);
};

TEST(FamilyGrowth, FindsAFamilyThatHasGrownByThree) {
  FamilyPast past;
  EXPECT_FALSE(past.grown(2.99));
  EXPECT_TRUE(past.grown(3.01));
}

TEST(FamilyGrowth, CountsNothingSmallBesideTheCutOrItsSwing) {
  FamilyPast past;
  EXPECT_FALSE(past.grown(3.9, 196.0));
  EXPECT_TRUE(past.grown(3.9, 194.0));
  EXPECT_FALSE(past.grown(3.9, 10.0, 39.1));
  EXPECT_TRUE(past.grown(3.9, 10.0, 38.9));
}

TEST(FamilyGrowth, JudgesNothingBeforeItHasAPast) {
  EXPECT_FALSE(FamilyPast(0.25).grown(100.0));
  FamilyPast past(0.275);
  EXPECT_TRUE(past.grown(100.0));
  past.test.forget();
  past.listen(0.25, 2.0);
  EXPECT_FALSE(past.grown(100.0));
  past.listen(hop_s, 2.0);
  EXPECT_NEAR(past.limit(), 6.0, 1e-9);  // and nothing of what was forgotten
}

// x(t) = b + (a - b) exp(-t/τ) from a = 1; τ = 2 s, and 10 s of what has grown.
TEST(FamilyGrowth, IsSlowToGetUsedToWhatGrows) {
  FamilyPast risen;
  risen.listen(2.0, 2.0);
  EXPECT_NEAR(risen.limit(), 3.0 * (2.0 - std::exp(-1.0)), 0.02);
  FamilyPast grown;
  grown.listen(2.0, 50.0);
  EXPECT_NEAR(grown.limit(), 3.0 * (50.0 - 49.0 * std::exp(-0.2)), 0.1);
  FamilyPast kept;
  for (int k = 0; k < 400; ++k) kept.grown(2.0);
  EXPECT_NEAR(kept.limit(), 3.0, 1e-6);
}

/// P(X > x), X the sum of n exponential variables of mean 1.
double beyond(int n, double x) {
  double sum = 0.0, term = std::exp(-x);
  for (int i = 0; i < n; term *= x / ++i) sum += term;
  return sum;
}

// Steady energies X, the mean of n exponential ones. The past u stands where E[w (X - u)] = 0, w = 0.2 for X > 3 u and
// 1 below: 1 - u = 0.8 (E[X; X > 3 u] - u P(X > 3 u)). So often X exceeds 3 u, and a little oftener since u varies.
TEST(FamilyGrowth, ASteadyFamilyRarelyExceeds) {
  for (const int n : {1, 2, 4}) {
    double low = 0.5, high = 1.0;
    for (int k = 0; k < 50; ++k) {
      const double u = 0.5 * (low + high);
      (1.0 - u > 0.8 * (beyond(n + 1, 3.0 * u * n) - u * beyond(n, 3.0 * u * n)) ? low : high) = u;
    }
    const double expected = beyond(n, 3.0 * low * n);
    Random random(static_cast<std::uint64_t>(n));
    FamilyGrowth test(hop_s);
    const int hops = robomill::test::seeds(2'000'000);
    int exceeds = 0;
    for (int k = 0; k < hops; ++k) {
      double energy = 0.0;
      for (int i = 0; i < n; ++i) energy -= std::log(1.0 - random.uniform()) / n;
      if (test.step({.synchronous = 1.0, .family = energy}, 0.0, true)) ++exceeds;
    }
    const double rate = static_cast<double>(exceeds) / hops;
    EXPECT_GT(rate, 0.9 * expected) << n;
    EXPECT_LT(rate, 1.25 * expected) << n;
  }
}

}  // namespace growth_test_test
