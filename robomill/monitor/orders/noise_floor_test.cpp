// The noise beneath lines, of powers that are given.
#include "robomill/monitor/orders/noise_floor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/random.hpp"

namespace noise_floor_test {

using robomill::Random;
using robomill::monitor::NoiseFloor;

// The power of a line of white noise is exponential: its median is ln 2 of its mean.
TEST(NoiseFloor, IsTheMedianWhateverLinesStandAboveIt) {
  Random random(1);
  std::vector<float> power(4000);
  for (std::size_t i = 0; i < power.size(); ++i) {
    power[i] = static_cast<float>(-std::log(1.0 - random.uniform()));
    if (i % 40 == 0) power[i] = 1e6F;
  }
  NoiseFloor floor(power.size());
  double sum = 0.0;
  for (const float each : floor.of(power, 80)) {
    sum += each / static_cast<double>(power.size());
    EXPECT_LT(each, 2.0F);
    EXPECT_GT(each, 0.2F);
  }
  EXPECT_NEAR(sum, std::numbers::ln2, 0.1);  // a line in forty lifts the median a little
}

TEST(NoiseFloor, FollowsASlopeBetweenTheBlocks) {
  std::vector<float> power(1000);
  for (std::size_t i = 0; i < power.size(); ++i) power[i] = static_cast<float>(i);
  NoiseFloor floor(power.size());
  const auto out = floor.of(power, 50);
  for (std::size_t i = 30; i < 970; ++i) EXPECT_NEAR(out[i], power[i], 2.0F) << i;
}

TEST(NoiseFloor, IsDefinedForAnyBlockAndLength) {
  for (const std::size_t lines : {1U, 2U, 7U, 8U, 33U, 1000U}) {
    NoiseFloor floor(1000);
    const std::vector<float> power(lines, 3.0F);
    for (const std::size_t block : {0U, 1U, 8U, 64U, 5000U}) {
      const auto out = floor.of(power, block);
      ASSERT_EQ(out.size(), lines);
      EXPECT_TRUE(std::ranges::all_of(out, [](float each) { return each == 3.0F; })) << lines << " " << block;
    }
  }
}

}  // namespace noise_floor_test
