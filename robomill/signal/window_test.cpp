#include "robomill/signal/window.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/error.hpp"

namespace robomill::signal {
namespace window_test {

// Half-overlapped periodic Hann windows add up to one everywhere.
TEST(HannWindow, OverlappedByHalfAddsUpToOne) {
  const Eigen::VectorXd window = hann_window(64);
  for (Eigen::Index j = 0; j < 32; ++j) EXPECT_NEAR(window(j) + window(j + 32), 1.0, 1e-15);
  EXPECT_DOUBLE_EQ(window(0), 0.0);
}

// Coherent gain 1/2 and noise bandwidth 3/2 lines, as tabulated in [Harris1978] table 1.
TEST(HannWindow, HasItsTabulatedGainAndBandwidth) {
  const Eigen::VectorXd window = hann_window(1000);
  EXPECT_NEAR(window.mean(), 0.5, 1e-14);
  EXPECT_NEAR(1000.0 * window.squaredNorm() / std::pow(window.sum(), 2), 1.5, 1e-13);
}

TEST(ExponentialWindow, FallsToOneOverEInItsTimeConstant) {
  const Eigen::VectorXd window = exponential_window(2001, 1000.0, 0.5);
  EXPECT_DOUBLE_EQ(window(0), 1.0);
  EXPECT_NEAR(window(500), std::exp(-1.0), 1e-15);
  EXPECT_NEAR(window(2000), std::exp(-4.0), 1e-15);
}

TEST(ForceWindow, IsOneInsideAndZeroFarOutside) {
  const Eigen::VectorXd window = force_window(40, 10, 20, 3);
  for (Eigen::Index j = 10; j <= 20; ++j) EXPECT_DOUBLE_EQ(window(j), 1.0);
  EXPECT_NEAR(window(8), 0.5, 1e-15);
  EXPECT_NEAR(window(22), 0.5, 1e-15);
  EXPECT_DOUBLE_EQ(window(6), 0.0);
  EXPECT_DOUBLE_EQ(window(24), 0.0);
  for (Eigen::Index j = 0; j < 10; ++j) EXPECT_LE(window(j), window(j + 1));
}

TEST(ForceWindow, MayTouchTheEndsOfTheRecord) {
  EXPECT_DOUBLE_EQ(force_window(5, 0, 4, 3).sum(), 5.0);
  EXPECT_DOUBLE_EQ(force_window(1, 0, 0, 0)(0), 1.0);
}

TEST(Windows, RejectWhatMakesNoSense) {
  EXPECT_THROW(static_cast<void>(hann_window(0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(exponential_window(10, 0.0, 1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(exponential_window(10, 1.0, -1.0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(force_window(10, 5, 4, 0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(force_window(10, 5, 10, 0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(force_window(10, -1, 4, 0)), InvalidInput);
  EXPECT_THROW(static_cast<void>(force_window(10, 2, 4, -1)), InvalidInput);
}

}  // namespace window_test
}  // namespace robomill::signal
