#include "robomill/page/thin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "robomill/base/random.hpp"

namespace robomill::page {
namespace thin_test {

// Property: increasing indices, within the bound, and the extremes of the whole curve are among them.
TEST(Thin, KeepsPeaksAndDips) {
  Random random(21);
  for (int round = 0; round < 50; ++round) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(5000));
    const auto most = static_cast<Eigen::Index>(10 + random.index(500));
    Eigen::VectorXd values(n);
    for (double& value : values) value = random.uniform() < 0.02 ? NAN : random.normal();
    const std::vector<Eigen::Index> keep = thin(values, most);
    ASSERT_LE(static_cast<Eigen::Index>(keep.size()), std::max(most + 2, Eigen::Index{1}));
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (i > 0) {
        ASSERT_LT(keep[i - 1], keep[i]);
      }
      if (!std::isnan(values[keep[i]])) {
        low = std::min(low, values[keep[i]]);
        high = std::max(high, values[keep[i]]);
      }
    }
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    EXPECT_EQ(low, lowest);
    EXPECT_EQ(high, highest);
  }
}

// Property: increasing indices, and of every curve the extremes.
TEST(ThinTogether, KeepsThePeaksOfEveryCurve) {
  Random random(3);
  for (int round = 0; round < 30; ++round) {
    const auto n = static_cast<Eigen::Index>(100 + random.index(5000));
    const auto most = static_cast<Eigen::Index>(40 + random.index(400));
    std::vector<Eigen::VectorXd> curves(1 + random.index(5), Eigen::VectorXd(n));
    for (Eigen::VectorXd& curve : curves) {
      for (double& value : curve) value = random.normal();
    }
    const std::vector<Eigen::Index> keep = thin_together(curves, most);
    ASSERT_LE(static_cast<Eigen::Index>(keep.size()), most + 2 * static_cast<Eigen::Index>(curves.size()));
    EXPECT_EQ(std::ranges::adjacent_find(keep, std::greater_equal<>()), keep.end());
    for (const Eigen::VectorXd& curve : curves) {
      const Eigen::VectorXd shown = curve(keep);
      EXPECT_EQ(shown.maxCoeff(), curve.maxCoeff());
      EXPECT_EQ(shown.minCoeff(), curve.minCoeff());
    }
  }
}

}  // namespace thin_test
}  // namespace robomill::page
