// The test for exponential growth, on energies that are given.
#include "robomill/monitor/orders/runaway.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace runaway_test {

using namespace robomill;
using robomill::monitor::Runaway;

constexpr double hop_s = 0.025;
constexpr double hop_of_window = 1.0 / 6.0;  // of 0.15 s
constexpr double line_hz = 870.0;

/// E(n) = e^(r n)
std::vector<double> exponential(double rise, int hops) {
  std::vector<double> out;
  for (int k = 0; k < hops; ++k) out.push_back(1e-6 * std::exp(rise * k));
  return out;
}

/// The hop, from 0, at which it is found; -1: never.
int found_at(const std::vector<double>& energy, double share = 0.9, double hz_a_hop = 0.0) {
  Runaway test(hop_s);
  for (std::size_t k = 0; k < energy.size(); ++k) {
    if (test.step(line_hz + hz_a_hop * static_cast<double>(k), energy[k], share)) return static_cast<int>(k);
  }
  return -1;
}

/// ∫ w and ∫∫ w of a Hann window from 0 to 1 with ∫ w = 1: what it shows of a step, and of a ramp, t after it came.
double of_step(double t) {
  if (t <= 0.0) return 0.0;
  constexpr double turn = 2.0 * std::numbers::pi;
  return t >= 1.0 ? 1.0 : t - std::sin(turn * t) / turn;
}
double of_ramp(double t) {
  if (t <= 0.0) return 0.0;
  constexpr double turn = 2.0 * std::numbers::pi;
  return t >= 1.0 ? t - 0.5 : 0.5 * t * t - (1.0 - std::cos(turn * t)) / (turn * turn);
}

// The first energy is no rise.
TEST(Runaway, FindsExponentialGrowthAtItsFourthRise) {
  Random random(1);
  const int runs = test::seeds(1000);
  for (int run = 0; run < runs; ++run) {
    const double rise = random.uniform(0.6, 3.0);
    EXPECT_EQ(found_at(exponential(rise, 20)), 4) << rise;
    EXPECT_EQ(found_at(exponential(rise, 4)), -1) << rise;
  }
  EXPECT_EQ(found_at(exponential(0.51, 20)), 4);
  EXPECT_EQ(found_at(exponential(0.49, 100)), -1);
}

TEST(Runaway, AHopThatDoesNotRiseBeginsAnew) {
  std::vector<double> energy = exponential(1.0, 4);
  for (const double later : exponential(1.0, 5)) energy.push_back(later);
  EXPECT_EQ(found_at(energy), 8);
}

// Out of silence, wherever between two hops it begins, and from whichever hop on the line is strong.
TEST(Runaway, FindsNoStepAndNoRampThroughAWindow) {
  Random random(2);
  const int runs = test::seeds(20'000);
  for (int run = 0; run < runs; ++run) {
    const double begins = random.uniform();  // hops
    const double lasts = random.uniform(0.05, 4.0);
    const bool step = run % 2 == 0;
    const int counts_from = static_cast<int>(random.index(10));
    Runaway test(hop_s);
    for (int k = 0; k < 40; ++k) {
      const double t = (k - begins) * hop_of_window;
      const double amplitude = step ? of_step(t) : (of_ramp(t) - of_ramp(t - lasts)) / lasts;
      const double share = k < counts_from ? 0.1 : 0.9;
      ASSERT_FALSE(test.step(line_hz, amplitude * amplitude, share))
          << (step ? "step" : "ramp") << " of " << lasts << " at " << begins << ", from " << counts_from << ", hop "
          << k;
    }
  }
}

// r falls from hop to hop: the fourth may hold 0.6 of the mean of all four and no less.
TEST(Runaway, GrowthThatSlackensIsNone) {
  const auto last_rise = [](double rise) {
    std::vector<double> energy = exponential(1.0, 4);
    energy.push_back(energy.back() * std::exp(rise));
    return found_at(energy);
  };
  const double least = 0.6 * 3.0 / (4.0 - 0.6);  // r = 0.6 (3 + r)/4
  EXPECT_EQ(last_rise(least + 0.01), 4);
  EXPECT_EQ(last_rise(least - 0.01), -1);
}

TEST(Runaway, ALineThatMovesOrIsWeakIsNone) {
  EXPECT_EQ(found_at(exponential(1.0, 40), 0.31, 19.0), 4);
  EXPECT_EQ(found_at(exponential(1.0, 40), 0.31, -21.0), -1);
  EXPECT_EQ(found_at(exponential(1.0, 40), 0.29, 0.0), -1);
}

TEST(Runaway, StandsForAFifthOfASecondWhileTheLineIsStrong) {
  Runaway test(hop_s);
  const auto grow = [&] {
    bool found = false;
    for (const double energy : exponential(1.0, 5)) found = test.step(line_hz, energy, 0.9);
    return found;
  };
  EXPECT_TRUE(grow());
  EXPECT_TRUE(test.step(line_hz, 1.0, 0.31));
  EXPECT_FALSE(test.step(line_hz, 1.0, 0.29));
  EXPECT_TRUE(test.step(line_hz, 1.0, 0.31));
  test.reset();
  EXPECT_FALSE(test.step(line_hz, 1.0, 0.31));
  EXPECT_TRUE(grow());
  int stood = 0;
  while (stood < 100 && test.step(line_hz, 1e-6, 0.9)) ++stood;
  EXPECT_NEAR(stood * hop_s, 0.2, hop_s + 1e-9);
}

TEST(Runaway, TakesEnergiesOfAnyUnit) {
  for (const double unit : {1e-18, 1e18}) {
    std::vector<double> energy = exponential(0.8, 12);
    for (double& each : energy) each *= unit;
    EXPECT_EQ(found_at(energy), 4) << unit;
  }
  EXPECT_EQ(found_at(std::vector<double>(50, 0.0)), -1);
}

}  // namespace runaway_test
