#include "robomill/base/statistics.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace robomill {
namespace statistics_test {

TEST(Median, IsTheUpperOfTheTwoInTheMiddle) {
  EXPECT_EQ(median(std::vector<double>{3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median(Eigen::Vector2d(5.0, -1.0)), 5.0);
  EXPECT_EQ(median(std::vector<double>{}), 0.0);
}

}  // namespace statistics_test
}  // namespace robomill
