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
using robomill::monitor::FamilyPast;
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

/// The energy of a line that has grown by 10 dB; 0: none.
double grown(const GrowthTest::Verdict& verdict) {
  return verdict.growth >= GrowthTest::least_growth ? verdict.energy : 0.0;
}

TEST(GrowthTest, FindsALineThatHasGrownTenfold) {
  EXPECT_EQ(Past().step(1.0, 0.1).energy, 0.0);
  EXPECT_EQ(grown(Past().step(1.0, 0.1 * std::pow(10.0, 0.5))), 0.0);   // 5 dB
  EXPECT_EQ(grown(Past().step(1.0, 0.1 * std::pow(10.0, 0.95))), 0.0);  // 9.5 dB
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
    EXPECT_EQ(grown(Past().step(deeper, deeper * 0.1)), 0.0) << deeper;
    EXPECT_EQ(grown(Past().step(deeper, deeper * 0.9)), 0.0) << deeper;
    EXPECT_GT(grown(Past().step(deeper, deeper * 1.1)), 0.0) << deeper;
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
      (grown(past.step(1.0, middle)) > 0.0 ? high : low) = middle;
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

TEST(FamilyPast, IsTheMeanOfTwoSeconds) {
  FamilyPast past(hop_s);
  EXPECT_EQ(past.growth(1.0), 0.0);
  for (int k = 0; k < 400; ++k) past.learn(2.0);
  EXPECT_NEAR(past.growth(6.0), 3.0, 1e-6);
  // x(t) = b + (a - b) exp(-t/τ), τ = 2 s
  for (int k = 0; k < 80; ++k) past.learn(4.0);
  EXPECT_NEAR(4.0 / past.growth(4.0), 4.0 - 2.0 * std::exp(-1.0), 0.02);
  past.forget();
  EXPECT_EQ(past.growth(1.0), 0.0);
}

TEST(FamilyPast, IsKnownAfterAFifthOfASecond) {
  FamilyPast past(hop_s);
  for (int k = 0; k < 8; ++k) past.learn(1.0);
  EXPECT_EQ(past.growth(9.0), 0.0);
  past.learn(1.0);
  EXPECT_NEAR(past.growth(9.0), 9.0, 1e-9);
}

TEST(FamilyPast, IsSlowToGetUsedToWhatGrows) {
  FamilyPast past(hop_s);
  for (int k = 0; k < 800; ++k) past.learn(1.0);
  for (int k = 0; k < 80; ++k) past.learn(50.0);
  EXPECT_NEAR(50.0 / past.growth(50.0), 50.0 - 49.0 * std::exp(-0.2), 0.6);
}

}  // namespace growth_test_test
