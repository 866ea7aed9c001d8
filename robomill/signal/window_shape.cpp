#include "robomill/signal/window_shape.hpp"

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::signal {
namespace {

void require_even(Eigen::Index n) {
  if (n < 2 || n % 2 != 0) throw InvalidInput("n", static_cast<double>(n), "samples", "must be even and at least 2");
}

/// g or dg/du at u = d/n.
double cosine_sum(const std::vector<double>& c, double u) {
  double sum = 0.0;
  for (std::size_t j = 0; j < c.size(); ++j) sum += c[j] * std::cos(units::revolution * static_cast<double>(j) * u);
  return sum;
}
double cosine_sum_slope(const std::vector<double>& c, double u) {
  double sum = 0.0;
  for (std::size_t j = 1; j < c.size(); ++j) {
    const double rate = units::revolution * static_cast<double>(j);
    sum -= c[j] * rate * std::sin(rate * u);
  }
  return sum;
}
double place(Eigen::Index j, Eigen::Index n) {
  return static_cast<double>(j) / static_cast<double>(n) - 0.5;
}

}  // namespace

std::vector<double> window_cosines(WindowKind kind) {
  if (kind == WindowKind::hann) return {0.5, 0.5};
  return {0.35875, 0.48829, 0.14128, 0.01168};
}

Eigen::VectorXd window_samples(WindowKind kind, Eigen::Index n) {
  require_even(n);
  const std::vector<double> c = window_cosines(kind);
  Eigen::VectorXd g(n);
  for (Eigen::Index j = 0; j < n; ++j) g(j) = cosine_sum(c, place(j, n));
  return g;
}

Eigen::VectorXd window_derivative(WindowKind kind, Eigen::Index n, double sample_rate_hz) {
  require_even(n);
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  const std::vector<double> c = window_cosines(kind);
  const double per_second = sample_rate_hz / static_cast<double>(n);  // du/dt
  Eigen::VectorXd slope(n);
  for (Eigen::Index j = 0; j < n; ++j) slope(j) = cosine_sum_slope(c, place(j, n)) * per_second;
  return slope;
}

}  // namespace robomill::signal
