#pragma once
#include <array>
#include <cmath>

namespace robomill::robot {

/// A function's Taylor coefficients f, f', f''/2, f'''/6 at one point: arithmetic on them carries derivatives exactly.
struct Taylor {
  std::array<double, 4> c = {};

  Taylor() = default;
  Taylor(double value) : c{value, 0.0, 0.0, 0.0} {}  // NOLINT(google-explicit-constructor): numbers are constants
  /// From a value and three derivatives.
  template <class Row>
  static Taylor of(const Row& row) noexcept {
    Taylor out;
    out.c = {row(0), row(1), 0.5 * row(2), row(3) / 6.0};
    return out;
  }
  [[nodiscard]] double derivative(int order) const noexcept {
    constexpr std::array<double, 4> factorial = {1.0, 1.0, 2.0, 6.0};
    const auto k = static_cast<std::size_t>(order);
    return factorial[k] * c[k];
  }
};

inline Taylor operator+(const Taylor& a, const Taylor& b) noexcept {
  Taylor out;
  for (std::size_t k = 0; k < 4; ++k) out.c[k] = a.c[k] + b.c[k];
  return out;
}
inline Taylor operator-(const Taylor& a, const Taylor& b) noexcept {
  Taylor out;
  for (std::size_t k = 0; k < 4; ++k) out.c[k] = a.c[k] - b.c[k];
  return out;
}
inline Taylor operator*(const Taylor& a, const Taylor& b) noexcept {
  Taylor out;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i <= k; ++i) out.c[k] += a.c[i] * b.c[k - i];
  }
  return out;
}
/// From out · b = a.
inline Taylor operator/(const Taylor& a, const Taylor& b) noexcept {
  Taylor out;
  const double inverse = 1.0 / b.c[0];
  for (std::size_t k = 0; k < 4; ++k) {
    double left = a.c[k];
    for (std::size_t i = 0; i < k; ++i) left -= out.c[i] * b.c[k - i];
    out.c[k] = left * inverse;
  }
  return out;
}
/// From out · out = a, a > 0.
inline Taylor sqrt(const Taylor& a) noexcept {
  Taylor out;
  out.c[0] = std::sqrt(a.c[0]);
  const double inverse = 0.5 / out.c[0];
  for (std::size_t k = 1; k < 4; ++k) {
    double left = a.c[k];
    for (std::size_t i = 1; i < k; ++i) left -= out.c[i] * out.c[k - i];
    out.c[k] = left * inverse;
  }
  return out;
}

}  // namespace robomill::robot
