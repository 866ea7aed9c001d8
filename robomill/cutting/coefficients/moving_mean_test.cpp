#include "robomill/cutting/coefficients/moving_mean.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::cutting::detail {
namespace moving_mean_test {

TEST(MovingMean, AShortLoadCountsByItsShare) {
  MovingMean mean(0.1);
  EXPECT_EQ(mean.add(0.0, 1.0), 0.0);
  EXPECT_NEAR(mean.add(1000.0, 0.02), 200.0, 1e-9);
  EXPECT_NEAR(mean.add(0.0, 0.05), 200.0, 1e-9);
  EXPECT_NEAR(mean.add(1000.0, 1.0), 1000.0, 1e-9);
  EXPECT_NEAR(mean.add(0.0, 1.0), 1000.0, 1e-9) << "of the window that ends with the load";
  EXPECT_EQ(mean.add(0.0, 1.0), 0.0);
}

// Against the sum over small steps.
TEST(MovingMean, AgreesWithSmallSteps) {
  constexpr int steps_in_window = 200;
  for (int seed = 0; seed < test::seeds(50); ++seed) {
    Random random(5, static_cast<std::uint64_t>(seed));
    MovingMean mean(1.0);
    std::vector<double> sums(steps_in_window + 1, 0.0);  // of value times time, a step each
    for (int part = 0; part < 40; ++part) {
      const double value = random.index(3) == 0 ? 0.0 : random.uniform(0.0, 10.0);
      const auto steps = random.index(part % 2 == 0 ? 30 : 500);
      double most = 0.0;
      for (std::size_t i = 0; i <= steps; ++i) {
        if (i > 0) sums.push_back(sums.back() + value / steps_in_window);
        most = std::max(most, sums.back() - sums[sums.size() - 1 - steps_in_window]);
      }
      EXPECT_NEAR(mean.add(value, static_cast<double>(steps) / steps_in_window), most, 1e-9);
    }
  }
}

}  // namespace moving_mean_test
}  // namespace robomill::cutting::detail
