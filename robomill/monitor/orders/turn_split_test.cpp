#include "robomill/monitor/orders/turn_split.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace robomill::monitor {
namespace {

constexpr double rate_hz = 1000.0, rotation_hz = 10.0;
constexpr std::size_t hop = 25;

double sine(double hz, double t) {
  return std::sin(2.0 * std::numbers::pi * hz * t);
}

/// Hops of a signal of t from 0 on; the speed as tracked, and teeth.
void feed(TurnSplit& split, double seconds, double tracked_hz, const std::function<double(double)>& signal) {
  std::vector<float> samples(hop);
  for (std::size_t at = 0; static_cast<double>(at + hop) <= seconds * rate_hz; at += hop) {
    for (std::size_t i = 0; i < hop; ++i)
      samples[i] = static_cast<float>(signal(static_cast<double>(at + i) / rate_hz));
    split.push(samples, hop);
    split.step({.rotation_hz = tracked_hz, .hint_hz = tracked_hz, .teeth = 2}, 0);
  }
}

double forced(double t) {
  return t < 1.0 ? 0.01 * sine(10.0, t) : sine(20.0, t) + 0.5 * sine(40.0, t) + 0.2 * sine(10.0, t);
}

TEST(TurnSplit, OrdersRepeat) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.0, rotation_hz, forced);
  EXPECT_LT(split.ratio(), 0.03);
  EXPECT_FALSE(split.holds());
}

// A speed that is off by a few parts in a hundred is found.
TEST(TurnSplit, SeeksTheSpeed) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.0, 1.025 * rotation_hz, forced);
  EXPECT_LT(split.ratio(), 0.02);
}

// Σ A²/2 beside the orders to that on them; lines share it. Those midway between two orders lose nothing to them, and a
// third is added for what lines lose on average in four turns.
TEST(TurnSplit, LinesBesideTheOrdersAreTheRest) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 4.0, rotation_hz,
       [](double t) { return forced(t) + (t < 2.5 ? 0.0 : 0.7 * sine(34.5, t) + 0.7 * sine(54.5, t)); });
  EXPECT_NEAR(split.ratio(), 4.0 / 3.0 * 0.98 / 1.29, 0.08);
  EXPECT_TRUE(split.holds());
  EXPECT_GE(split.lasting(), 7.0 / 8.0);
}

// The calm before a cut is not forgotten in it, and a stream that begins in a cut has one.
TEST(TurnSplit, HoldsAfterALongCutAndAfterABeginningInIt) {
  const auto chatter = [](double t, double from) { return t < from ? 0.0 : 0.7 * sine(34.5, t) + 0.7 * sine(54.5, t); };
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 61.5, rotation_hz, [&](double t) { return forced(t) + chatter(t, 60.0); });
  EXPECT_TRUE(split.holds());
  split.reset();
  feed(split, 31.5, rotation_hz, [&](double t) { return forced(t + 2.0) + chatter(t, 30.0); });
  EXPECT_TRUE(split.holds());
  split.reset();
  feed(split, 5.0, rotation_hz, [](double t) { return forced(t + 2.0); });
  EXPECT_FALSE(split.holds());
}

// A controller's trace of 1 kHz is not reduced: orders repeat up to half of it.
TEST(TurnSplit, HighOrdersRepeat) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.0, rotation_hz, [](double t) { return forced(t) + (t < 1.0 ? 0.0 : sine(380.0, t) + sine(440.0, t)); });
  EXPECT_LT(split.ratio(), 0.05);
}

// Samples that are lost change nothing.
TEST(TurnSplit, WaitsWithoutAChannel) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.0, rotation_hz, forced);
  const double above_quiet = split.above_quiet();
  for (int i = 0; i < 8; ++i) split.step({.rotation_hz = rotation_hz, .hint_hz = rotation_hz, .teeth = 2}, 1);
  EXPECT_EQ(split.above_quiet(), above_quiet);
  EXPECT_GT(above_quiet, 1000.0);
}

// As after construction.
TEST(TurnSplit, IsResetWhole) {
  TurnSplit split(rate_hz, 1, 0.025), fresh(rate_hz, 1, 0.025);
  feed(split, 2.475, rotation_hz, forced);
  split.reset();
  feed(split, 3.0, rotation_hz, forced);
  feed(fresh, 3.0, rotation_hz, forced);
  EXPECT_EQ(split.ratio(), fresh.ratio());
  EXPECT_EQ(split.rise(), fresh.rise());
  EXPECT_EQ(split.lasting(), fresh.lasting());
}

// What rings after a knock falls within the window.
TEST(TurnSplit, RingingDoesNotHold) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.0, rotation_hz,
       [](double t) { return forced(t) + (t < 2.6 ? 0.0 : 0.7 * std::exp(-4.0 * (t - 2.6)) * sine(34.5, t)); });
  EXPECT_LT(split.holding(), 0.8);
}

// Hum of a pump that starts: nothing that repeats came with it.
TEST(TurnSplit, AToneThatBeginsInAirIsNoChatter) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.1, rotation_hz,
       [](double t) { return 0.01 * sine(10.0, t) + (t < 2.5 ? 0.02 : 0.055) * sine(34.5, t); });
  EXPECT_GT(split.ratio(), 5.0);
  EXPECT_GE(split.rise(), 4.0);
  EXPECT_LT(split.repeating_above_quiet(), 2.0);
  EXPECT_FALSE(split.holds());
}

// Where the tool leaves, what repeats goes.
TEST(TurnSplit, AnExitIsNoChatter) {
  TurnSplit split(rate_hz, 1, 0.025);
  feed(split, 3.45, rotation_hz, [](double t) { return t < 3.0 ? forced(t) : 0.9 * sine(34.5, t); });
  EXPECT_GT(split.ratio(), 0.3);
  EXPECT_LT(split.repeating(), 0.2);
  EXPECT_FALSE(split.holds());
}

}  // namespace
}  // namespace robomill::monitor
