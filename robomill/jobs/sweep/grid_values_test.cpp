#include "robomill/jobs/sweep/grid_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "robomill/base/random.hpp"

namespace robomill::jobs {
namespace grid_values_test {

using Function = std::function<double(double, double)>;

const BoundaryOptions square = {.axes = {{.count = 5}, {.low = -1.0, .high = 1.0, .count = 5}}, .halvings = 1};

class Interpolation : public ::testing::Test {
 protected:
  /// Fills the coarse grid.
  void fill(const Function& f, double error = 0.0) {
    for (std::uint64_t i = 0; i < 9; i += 2) {
      for (std::uint64_t k = 0; k < 9; k += 2) known_.set(point(i, k), {.value = f(x(i), y(k)), .error = error});
    }
  }
  [[nodiscard]] std::uint64_t point(std::uint64_t i, std::uint64_t k) const { return i * grid_.stride(0) + k; }
  [[nodiscard]] double x(std::uint64_t i) const { return grid_.at(0, static_cast<double>(i)); }
  [[nodiscard]] double y(std::uint64_t k) const { return grid_.at(1, static_cast<double>(k)); }

  BoundaryGrid grid_{square};
  GridValues known_{grid_};
};

TEST_F(Interpolation, IsExactForCubicsInsideAndForParabolasAtTheEnds) {
  fill([](double x, double y) { return 1.0 + x - 2.0 * x * x + 3.0 * x * x * x + y; });
  for (const std::uint64_t i : {3U, 5U}) {
    const GridValue found = known_.interpolated(point(i, 4), 1).value();
    EXPECT_NEAR(found.value, 1.0 + x(i) - 2.0 * x(i) * x(i) + 3.0 * std::pow(x(i), 3), 1e-14);
  }
  fill([](double x, double y) { return 1.0 + x - 2.0 * x * x + y; });
  for (const std::uint64_t i : {1U, 7U}) {
    const GridValue found = known_.interpolated(point(i, 4), 1).value();
    EXPECT_NEAR(found.value, 1.0 + x(i) - 2.0 * x(i) * x(i), 1e-15);
    EXPECT_NEAR(found.error, 2.0 * 2.0 * 0.25 * 0.25, 1e-14) << "f'' h^2, of the coarse steps";
  }
}

TEST_F(Interpolation, HasItsErrorWithinTheEstimateAcrossKinksAndSteps) {
  Random random(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const double at = random.uniform(0.0, 1.0), slope = random.uniform(-3.0, 3.0), bend = random.uniform(-9.0, 9.0);
    const bool jumps = trial % 2 == 1;
    const Function f = [&](double x, double) { return slope * x + (x < at ? 0.0 : jumps ? bend : bend * (x - at)); };
    fill(f);
    for (const std::uint64_t i : {1U, 3U, 5U, 7U}) {
      const GridValue found = known_.interpolated(point(i, 2), 1).value();
      const double share = i == 1 || i == 7 ? 0.625 : 0.5;
      ASSERT_LE(std::abs(found.value - f(x(i), 0.0)), share * found.error + 1e-14) << at;
    }
  }
}

TEST_F(Interpolation, TakesTheAxisWithTheLeastError) {
  fill([](double x, double y) { return std::sin(20.0 * x) + y; });
  for (const std::uint64_t i : {2U, 4U}) known_.set(point(i, 3), {.value = std::sin(20.0 * x(i)) + y(3)});
  for (std::uint64_t k = 0; k < 9; k += 2) known_.set(point(3, k), {.value = std::sin(20.0 * x(3)) + y(k)});
  const GridValue found = known_.interpolated(point(3, 3), 1).value();
  EXPECT_NEAR(found.value, std::sin(20.0 * x(3)) + y(3), 1e-14);
  EXPECT_LT(found.error, 1e-13);
  EXPECT_EQ(known_.axes_between(point(3, 3), 1), 2U);
  EXPECT_EQ(known_.axes_between(point(3, 4), 1), 1U);
  EXPECT_EQ(known_.axes_between(point(2, 4), 1), 0U);
  EXPECT_EQ(known_.axes_between(point(2, 4), 2), 1U);
}

TEST_F(Interpolation, AddsTheErrorsOfWhatItIsFrom) {
  fill([](double x, double) { return x; }, 0.1);
  EXPECT_NEAR(known_.interpolated(point(3, 4), 1)->error, 0.1 * 20.0 / 16.0, 1e-14);
  EXPECT_NEAR(known_.interpolated(point(1, 4), 1)->error, 0.1 * 10.0 / 8.0, 1e-14);
}

TEST_F(Interpolation, NeedsThreeFiniteValuesOnALine) {
  fill([](double x, double) { return x; });
  EXPECT_TRUE(known_.interpolated(point(3, 4), 1));
  EXPECT_FALSE(known_.interpolated(point(4, 4), 1)) << "a point of the grid";
  EXPECT_FALSE(known_.interpolated(point(3, 3), 1)) << "its neighbours are not known";
  known_.set(point(0, 4), {.value = std::nan("")});
  EXPECT_NEAR(known_.interpolated(point(3, 4), 1)->value, x(3), 1e-15) << "by the three others";
  known_.set(point(6, 4), {.value = std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(known_.interpolated(point(3, 4), 1));
  known_.set(point(6, 4), {.value = x(6)});
  known_.set(point(2, 4), {.value = std::numeric_limits<double>::infinity()});
  EXPECT_FALSE(known_.interpolated(point(3, 4), 1));
}

}  // namespace grid_values_test
}  // namespace robomill::jobs
