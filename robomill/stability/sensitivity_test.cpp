// What limits are sensitive to.
#include "robomill/stability/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/stability/collocation/mode_sensitivity.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace sensitivity_test {

using testing::rpm;

// Two ways: eigenvectors of the period over the modes, and differences of radii found by Arnoldi's iteration.
void expect_both_ways(const LobesProblem& problem, const OperatingPoint& point) {
  const LimitSensitivity by_vectors = limit_sensitivity(problem, point);
  const auto by_differences = detail::mode_differences(problem, point, 4, 1e-6);
  ASSERT_EQ(by_vectors.modes.size(), by_differences.size());
  double size = 0.0;
  for (const auto& mode : by_differences) size = std::max({size, std::abs(mode.frequency), std::abs(mode.residue)});
  for (std::size_t k = 0; k < by_differences.size(); ++k) {
    EXPECT_NEAR(by_vectors.modes[k].frequency, by_differences[k].frequency, 1e-4 * size) << k;
    EXPECT_NEAR(by_vectors.modes[k].damping_ratio, by_differences[k].damping_ratio, 1e-4 * size) << k;
    EXPECT_NEAR(by_vectors.modes[k].residue, by_differences[k].residue, 1e-4 * size) << k;
  }
}

TEST(LimitSensitivity, OfEigenvectorsIsThatOfDifferences) {
  for (const auto& known : testing::spatial_references()) {
    expect_both_ways(known.problem, {known.limit_speed_rpm * rpm, 1e-3 * known.limit_mm});
  }
  expect_both_ways(testing::benchmark(0.3), {5000 * rpm, 0.4e-3});
  expect_both_ways(testing::benchmark(1.0), {9000 * rpm, 0.4e-3});
  expect_both_ways(testing::robot(), {6500 * rpm, 0.5e-3});
}

}  // namespace sensitivity_test
}  // namespace robomill::stability
