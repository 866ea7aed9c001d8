#include "robomill/signal/window_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/signal/window.hpp"
#include "testing/support.hpp"

namespace robomill::signal {
namespace window_shape_test {

constexpr WindowKind all_kinds[] = {WindowKind::hann, WindowKind::blackman_harris};

TEST(WindowShape, HannIsTheWindowOfTheSpectra) {
  const Eigen::VectorXd expected = hann_window(64);
  EXPECT_LT((window_samples(WindowKind::hann, 64) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

// Noise bandwidths in lines of [Harris1978] table 1.
TEST(WindowShape, HasTheTabulatedNoiseBandwidths) {
  const auto bandwidth = [](WindowKind kind) {
    const Eigen::VectorXd g = window_samples(kind, 4096);
    return 4096.0 * g.squaredNorm() / std::pow(g.sum(), 2);
  };
  EXPECT_NEAR(bandwidth(WindowKind::hann), 1.50, 0.005);
  EXPECT_NEAR(bandwidth(WindowKind::blackman_harris), 2.00, 0.005);
}

TEST(WindowShape, DerivativeIsTheLimitOfDifferences) {
  const Eigen::Index n = 1 << 14;
  const double rate_hz = 10240.0;
  for (const WindowKind kind : all_kinds) {
    const Eigen::VectorXd g = window_samples(kind, n), slope = window_derivative(kind, n, rate_hz);
    const double largest = slope.cwiseAbs().maxCoeff();
    for (Eigen::Index j = 2; j + 2 < n; j += 37) {
      const double difference = (8.0 * (g(j + 1) - g(j - 1)) - (g(j + 2) - g(j - 2))) / 12.0 * rate_hz;
      EXPECT_NEAR(slope(j), difference, 1e-7 * largest) << static_cast<int>(kind) << " at " << j;
    }
  }
}

TEST(WindowShape, DerivativeIsPerSecond) {
  const Eigen::VectorXd slow = window_derivative(WindowKind::hann, 64, 1.0),
                        fast = window_derivative(WindowKind::hann, 64, 1000.0);
  EXPECT_LT((1000.0 * slow - fast).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(WindowShape, IsEvenAboutItsCentreAndItsDerivativeOdd) {
  for (const WindowKind kind : all_kinds) {
    const Eigen::VectorXd g = window_samples(kind, 128), slope = window_derivative(kind, 128, 1.0);
    for (Eigen::Index d = 1; d < 64; ++d) {
      EXPECT_NEAR(g(64 + d), g(64 - d), 1e-15);
      EXPECT_NEAR(slope(64 + d), -slope(64 - d), 1e-15);
    }
    EXPECT_NEAR(g(64), 1.0, 1e-8);
  }
}

TEST(WindowShape, RejectsWhatMakesNoSense) {
  EXPECT_EQ(test::field_of([] { static_cast<void>(window_samples(WindowKind::hann, 7)); }), "n");
  EXPECT_EQ(test::field_of([] { static_cast<void>(window_derivative(WindowKind::hann, 8, 0.0)); }), "sample_rate_hz");
}

}  // namespace window_shape_test
}  // namespace robomill::signal
