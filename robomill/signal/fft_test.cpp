#include "robomill/signal/fft.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill::signal {
namespace fft_test {

Eigen::VectorXd random_signal(Eigen::Index n) {
  Random random(static_cast<std::uint64_t>(n));
  Eigen::VectorXd x(n);
  for (double& value : x) value = random.normal();
  return x;
}

class Fft : public ::testing::TestWithParam<int> {};

TEST_P(Fft, IsTheDefiningSum) {
  const Eigen::Index n = GetParam();
  const Eigen::VectorXd x = random_signal(n);
  const Eigen::VectorXcd spectrum = real_fft(x);
  ASSERT_EQ(spectrum.size(), n / 2 + 1);
  for (Eigen::Index k = 0; k < spectrum.size(); k += 1 + n / 26) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      sum +=
          x(j) * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>((j * k) % n) / static_cast<double>(n));
    }
    EXPECT_LT(std::abs(spectrum(k) - sum), 1e-13 * static_cast<double>(n) + 1e-14);
  }
}

TEST_P(Fft, InverseGivesTheSignalBack) {
  const Eigen::VectorXd x = random_signal(GetParam());
  EXPECT_LT((inverse_real_fft(real_fft(x), x.size()) - x).norm(), 1e-13 * x.norm());
}

// 2 · 53 and the primes go through Bluestein's method, the others through the mixed radix.
INSTANTIATE_TEST_SUITE_P(Lengths, Fft, testing::Values(1, 2, 3, 4, 5, 7, 16, 47, 53, 106, 360, 997, 1024, 4099));

TEST(FftInput, RejectsEmptyAndMisfit) {
  EXPECT_THROW(static_cast<void>(real_fft(Eigen::VectorXd())), InvalidInput);
  EXPECT_THROW(static_cast<void>(inverse_real_fft(Eigen::VectorXcd::Zero(3), 6)), InvalidInput);
}

}  // namespace fft_test
}  // namespace robomill::signal
