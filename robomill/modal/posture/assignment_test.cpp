#include "robomill/modal/posture/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "robomill/base/random.hpp"

namespace robomill::modal::detail {
namespace assignment_test {

/// The least sum over all ways to pair, one by one.
double least_sum(const Eigen::MatrixXd& cost) {
  if (cost.rows() > cost.cols()) return least_sum(cost.transpose());
  std::vector<Eigen::Index> columns(static_cast<std::size_t>(cost.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < cost.rows(); ++i) sum += cost(i, columns[static_cast<std::size_t>(i)]);
    least = std::min(least, sum);
  } while (std::next_permutation(columns.begin(), columns.end()));
  return least;
}

TEST(Assignment, IsTheCheapestOfAllPairings) {
  Random random(5);
  for (int k = 0; k < 200; ++k) {
    const auto rows = static_cast<Eigen::Index>(1 + random.index(6)),
               columns = static_cast<Eigen::Index>(1 + random.index(6));
    Eigen::MatrixXd cost(rows, columns);
    for (double& entry : cost.reshaped()) entry = k % 3 == 0 ? static_cast<double>(random.index(3)) : random.normal();
    const std::vector<Eigen::Index> pairs = assign(cost);
    std::vector<int> taken(static_cast<std::size_t>(columns), 0);
    double sum = 0.0;
    Eigen::Index paired = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Eigen::Index j = pairs[static_cast<std::size_t>(i)];
      if (j < 0) continue;
      sum += cost(i, j);
      ++paired;
      EXPECT_EQ(++taken[static_cast<std::size_t>(j)], 1);
    }
    EXPECT_EQ(paired, std::min(rows, columns));
    EXPECT_NEAR(sum, least_sum(cost), 1e-12);
  }
}

}  // namespace assignment_test
}  // namespace robomill::modal::detail
