#include "robomill/signal/fft.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill::signal {
namespace fft_test {

Eigen::VectorXcd random_signal(Eigen::Index n) {
  Random random(static_cast<std::uint64_t>(n));
  Eigen::VectorXcd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x(i) = {random.normal(), random.normal()};
  return x;
}

class Fft : public ::testing::TestWithParam<int> {};

TEST_P(Fft, IsTheDefiningSum) {
  const Eigen::Index n = GetParam();
  const Eigen::VectorXcd x = random_signal(n);
  const Eigen::VectorXcd spectrum = fft(x);
  for (Eigen::Index k = 0; k < n; k += 1 + n / 13) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      sum +=
          x(j) * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>((j * k) % n) / static_cast<double>(n));
    }
    EXPECT_LT(std::abs(spectrum(k) - sum), 1e-13 * static_cast<double>(n) + 1e-14);
  }
}

TEST_P(Fft, InverseGivesTheSignalBack) {
  const Eigen::VectorXcd x = random_signal(GetParam());
  EXPECT_LT((inverse_fft(fft(x)) - x).norm(), 1e-13 * x.norm());
  const Eigen::VectorXd real = x.real();
  EXPECT_LT((inverse_real_fft(real_fft(real), real.size()) - real).norm(), 1e-13 * real.norm());
}

// 2 · 53 and the primes go through Bluestein's method, the others through the mixed radix.
INSTANTIATE_TEST_SUITE_P(Lengths, Fft, testing::Values(1, 2, 3, 4, 5, 7, 16, 47, 53, 106, 360, 997, 1024, 4099));

TEST(FftInput, RejectsEmptyAndMisfit) {
  EXPECT_THROW(static_cast<void>(fft(Eigen::VectorXcd())), InvalidInput);
  EXPECT_THROW(static_cast<void>(inverse_real_fft(Eigen::VectorXcd::Zero(3), 6)), InvalidInput);
}

}  // namespace fft_test
}  // namespace robomill::signal
