#include "robomill/signal/fft.hpp"

#include <kissfft.hh>

#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::signal {
namespace {

using Complex = std::complex<double>;

Eigen::Index largest_prime_factor(Eigen::Index n) {
  Eigen::Index largest = 1;
  for (Eigen::Index p = 2; p * p <= n; ++p) {
    for (; n % p == 0; n /= p) largest = p;
  }
  return std::max(largest, n);
}

Eigen::VectorXcd mixed_radix(const Eigen::VectorXcd& x, bool inverse) {
  Eigen::VectorXcd out(x.size());
  kissfft<double> plan(static_cast<std::size_t>(x.size()), inverse);
  plan.transform(x.data(), out.data());
  return out;
}

// jk = (j² + k² - (k - j)²)/2 turns the sum into a convolution, done at a power of two.
Eigen::VectorXcd bluestein(const Eigen::VectorXcd& x, bool inverse) {
  const Eigen::Index n = x.size();
  Eigen::Index m = 1;
  while (m < 2 * n - 1) m *= 2;
  Eigen::VectorXcd chirp(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    // j² mod 2n keeps the angle small, so that no digits are lost at large j.
    const double turns = static_cast<double>((j * j) % (2 * n)) / static_cast<double>(2 * n);
    chirp(j) = std::polar(1.0, (inverse ? 2.0 : -2.0) * std::numbers::pi * turns);
  }
  Eigen::VectorXcd a = Eigen::VectorXcd::Zero(m);
  Eigen::VectorXcd b = Eigen::VectorXcd::Zero(m);
  a.head(n) = x.cwiseProduct(chirp);
  b.head(n) = chirp.conjugate();
  for (Eigen::Index j = 1; j < n; ++j) b(m - j) = b(j);
  const Eigen::VectorXcd product = mixed_radix(a, false).cwiseProduct(mixed_radix(b, false));
  return mixed_radix(product, true).head(n).cwiseProduct(chirp) / static_cast<double>(m);
}

Eigen::VectorXcd transform(const Eigen::VectorXcd& x, bool inverse) {
  if (x.size() == 0) throw InvalidInput("signal", "is empty");
  return largest_prime_factor(x.size()) > 50 ? bluestein(x, inverse) : mixed_radix(x, inverse);
}

}  // namespace

Eigen::VectorXcd real_fft(const Eigen::Ref<const Eigen::VectorXd>& x) {
  return transform(x.cast<Complex>(), false).head(x.size() / 2 + 1);
}

Eigen::VectorXd inverse_real_fft(const Eigen::Ref<const Eigen::VectorXcd>& half, Eigen::Index n) {
  if (n < 1 || half.size() != n / 2 + 1) {
    throw InvalidInput("spectrum", "must have n/2 + 1 lines for a signal of length n");
  }
  Eigen::VectorXcd full(n);
  full.head(half.size()) = half;
  full(0) = half(0).real();
  if (n % 2 == 0) full(n / 2) = half(n / 2).real();
  for (Eigen::Index k = 1; k < (n + 1) / 2; ++k) full(n - k) = std::conj(half(k));
  return transform(full, true).real() / static_cast<double>(n);
}

}  // namespace robomill::signal
