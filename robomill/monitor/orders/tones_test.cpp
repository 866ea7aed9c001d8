// What stood before, in cells whose energies are given.
#include "robomill/monitor/orders/tones.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tones_test {

using robomill::monitor::Tones;

constexpr double hop_s = 0.025;
constexpr std::size_t cells = 100, place = 40;

std::vector<double> line(double energy, std::size_t at = place) {
  std::vector<double> out(cells, 1e-6);
  out[at] = energy;
  return out;
}

Tones past_of(const std::vector<double>& energy, int hops = 80) {
  Tones out(cells, hop_s);
  for (int k = 0; k < hops; ++k) out.learn(energy);
  return out;
}

TEST(Tones, NothingStoodBeforeSomethingIsLearnt) {
  EXPECT_FALSE(past_of(line(1.0), 0).stood(place, line(1.0)));
  EXPECT_FALSE(past_of(line(1.0), 11).stood(place, line(1.0)));
  EXPECT_TRUE(past_of(line(1.0), 12).stood(place, line(1.0)));  // 0.3 s
}

TEST(Tones, AToneStoodUntilItHasGrownByFour) {
  const Tones tones = past_of(line(1.0));
  for (const double energy : {0.0, 0.1, 1.0, 3.99}) EXPECT_TRUE(tones.stood(place, line(energy))) << energy;
  for (const double energy : {4.01, 100.0}) EXPECT_FALSE(tones.stood(place, line(energy))) << energy;
  EXPECT_FALSE(tones.stood(place + 20, line(1.0, place + 20)));
}

TEST(Tones, AToneMayMoveByTwoCells) {
  const Tones tones = past_of(line(1.0));
  for (std::size_t at = place - 4; at <= place + 4; ++at) {
    const bool near = at + 2 >= place && at <= place + 2;
    EXPECT_EQ(tones.stood(at, line(1.0, at)), near) << at;
  }
}

// The mean over the first second, and from then on x(t) = b + (a - b) exp(-t/τ), τ = 1 s.
TEST(Tones, ForgetsWithinASecond) {
  const auto level = [](const Tones& tones) {
    double low = 0.0, high = 100.0;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (tones.stood(place, line(middle)) ? low : high) = middle;
    }
    return low / 4.0;
  };
  Tones young = past_of(line(3.0), 10);
  for (int k = 0; k < 10; ++k) young.learn(line(1.0));
  EXPECT_NEAR(level(young), 2.0, 1e-4);
  Tones old = past_of(line(1.0), 200);
  for (int k = 0; k < 40; ++k) old.learn(line(9.0));
  EXPECT_NEAR(level(old), 9.0 - 8.0 * std::exp(-1.0), 0.05);
}

TEST(Tones, ResetForgetsAll) {
  Tones tones = past_of(line(1e6));
  tones.reset();
  EXPECT_FALSE(tones.stood(place, line(1.0)));
  for (int k = 0; k < 12; ++k) tones.learn(line(1.0));
  EXPECT_TRUE(tones.stood(place, line(1.0)));
  EXPECT_FALSE(tones.stood(place, line(5.0)));
}

TEST(Tones, TheFirstAndTheLastCellsAreLikeAllOthers) {
  for (const std::size_t at : {std::size_t{0}, std::size_t{1}, cells - 2, cells - 1}) {
    const Tones tones = past_of(line(1.0, at));
    EXPECT_TRUE(tones.stood(at, line(3.9, at))) << at;
    EXPECT_FALSE(tones.stood(at, line(4.1, at))) << at;
    EXPECT_FALSE(tones.stood(cells - 1 - at, line(1.0, cells - 1 - at))) << at;
  }
}

}  // namespace tones_test
