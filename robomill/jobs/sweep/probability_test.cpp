#include "robomill/jobs/sweep/probability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace robomill::jobs {
namespace probability_test {

constexpr double inf = std::numeric_limits<double>::infinity();

// Its ends solve the equation that it is defined by, and of none it ends at z^2 / (n + z^2).
TEST(WilsonInterval, SolvesItsEquation) {
  constexpr double z = 1.959963984540054;
  for (const std::size_t n : {1U, 7U, 50U, 1000U}) {
    for (std::size_t k = 0; k <= n; k += n / 7 + 1) {
      const Estimate found = wilson_interval(k, n);
      EXPECT_LE(found.low, found.value);
      EXPECT_GE(found.high, found.value);
      for (const double p : {found.low, found.high}) {
        if (p == 0.0 || p == 1.0) continue;
        EXPECT_NEAR(std::abs(found.value - p), z * std::sqrt(p * (1.0 - p) / static_cast<double>(n)), 1e-12);
      }
    }
    EXPECT_EQ(wilson_interval(0, n).low, 0.0);
    EXPECT_NEAR(wilson_interval(0, n).high, z * z / (static_cast<double>(n) + z * z), 1e-12);
    EXPECT_EQ(wilson_interval(n, n).high, 1.0);
  }
  EXPECT_TRUE(std::isnan(wilson_interval(0, 0).value));
}

// By all outcomes of n draws: on the mean over p it covers p in 95 % of them, and never in fewer than 83 %.
TEST(WilsonInterval, CoversTheProbabilityItIsDrawnFrom) {
  constexpr std::size_t n = 50;
  double mean = 0.0, least = 1.0;
  constexpr int steps = 999;
  for (int i = 1; i <= steps; ++i) {
    const double p = i / (steps + 1.0);
    double covered = 0.0;
    for (std::size_t k = 0; k <= n; ++k) {
      const Estimate interval = wilson_interval(k, n);
      if (p < interval.low || p > interval.high) continue;
      const auto x = static_cast<double>(k), m = static_cast<double>(n);
      covered += std::exp(std::lgamma(m + 1.0) - std::lgamma(x + 1.0) - std::lgamma(m - x + 1.0) + x * std::log(p) +
                          (m - x) * std::log1p(-p));
    }
    mean += covered / steps;
    least = std::min(least, covered);
  }
  EXPECT_NEAR(mean, 0.95, 0.01);
  EXPECT_GT(least, 0.83);
}

TEST(ConditionShare, CountsWhatHoldsAndWhatHasNoValue) {
  const std::vector<double> values = {0.3, 0.5, inf, std::nan(""), 0.7, 0.1};
  const ConditionShare deep = share_of(values, {.at_least = 0.5}, 0.2);
  EXPECT_EQ(deep.points, 5U);
  EXPECT_EQ(deep.holding, 3U);
  EXPECT_EQ(deep.infinite, 1U);
  EXPECT_EQ(deep.left_out, 1U);
  EXPECT_DOUBLE_EQ(deep.share.value, 0.6);
  EXPECT_EQ(deep.worst, 0.3) << "one of five lies below";
  const ConditionShare few = share_of(values, {.at_most = 0.5}, 0.2);
  EXPECT_EQ(few.holding, 3U);
  EXPECT_EQ(few.worst, 0.7) << "one of five lies above";
  EXPECT_EQ(share_of(values, {.at_least = 0.5}, 0.1).worst, 0.1);
  EXPECT_EQ(share_of({}, {.at_least = 0.5}, 0.1).points, 0U);
}

// Of n even steps from 0 to 1 the condition x >= c holds for the share 1 - c.
TEST(ConditionShare, OfEvenSamplesIsTheLengthOfTheRange) {
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back((i + 0.5) / 1000.0);
  EXPECT_NEAR(share_of(values, {.at_least = 0.37}, 0.05).share.value, 0.63, 1e-3);
  EXPECT_NEAR(share_of(values, {.at_least = 0.37}, 0.05).worst, 0.05, 1e-3);
  EXPECT_NEAR(share_of(values, {.at_most = 0.37}, 0.05).worst, 0.95, 1e-3);
}

}  // namespace probability_test
}  // namespace robomill::jobs
