#include "robomill/base/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace robomill {
namespace random_test {

TEST(Random, SameSeedAndStreamGiveTheSameNumbers) {
  Random a(7, 3);
  Random b(7, 3);
  Random other(7, 4);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double value = a.uniform();
    EXPECT_EQ(value, b.uniform());
    differs = differs || value != other.uniform();
  }
  EXPECT_TRUE(differs);
}

// Moments of n draws stay within five standard errors of the distribution's.
TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  Random random(1);
  const int n = 200000;
  std::array<double, 4> moment{};
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    for (std::size_t k = 0; k < 4; ++k) moment[k] += std::pow(x, static_cast<double>(k + 1)) / n;
  }
  const double root = std::sqrt(static_cast<double>(n));
  EXPECT_NEAR(moment[0], 0.0, 5.0 / root);
  EXPECT_NEAR(moment[1], 1.0, 5.0 * std::sqrt(2.0) / root);
  EXPECT_NEAR(moment[2], 0.0, 5.0 * std::sqrt(15.0) / root);
  EXPECT_NEAR(moment[3], 3.0, 5.0 * std::sqrt(96.0) / root);
}

TEST(Random, IndexIsEvenlySpread) {
  Random random(2);
  std::array<int, 7> count{};
  const int n = 70000;
  for (int i = 0; i < n; ++i) ++count.at(static_cast<std::size_t>(random.index(7)));
  for (const int c : count) EXPECT_NEAR(c, n / 7, 5.0 * std::sqrt(n / 7.0));
}

}  // namespace random_test
}  // namespace robomill
