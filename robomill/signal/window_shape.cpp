#include "robomill/signal/window_shape.hpp"

#include <cmath>
#include <mutex>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::signal {
namespace {

/// I_order(z), one thread at a time: std::cyl_bessel_i calls lgamma, which writes the C library's signgam.
double bessel_i(double order, double z) {
  static std::mutex one;
  const std::lock_guard lock(one);
  return std::cyl_bessel_i(order, z);
}

double parameter_of(const WindowShape& shape) {
  if (shape.parameter > 0.0) return shape.parameter;
  return shape.kind == WindowKind::gaussian ? 0.125 : 9.0;
}

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
double gaussian(double sigma, double u) {
  return std::exp(-0.5 * (u / sigma) * (u / sigma));
}
double kaiser(double beta, double u) {
  return bessel_i(0.0, beta * std::sqrt(std::max(0.0, 1.0 - 4.0 * u * u))) / bessel_i(0.0, beta);
}
/// dI0(z)/du = I1(z) dz/du with z = β √(1 - 4u²): -4 β² u I1(z)/z, and I1(z)/z → 1/2 at the ends.
double kaiser_slope(double beta, double u) {
  const double z = beta * std::sqrt(std::max(0.0, 1.0 - 4.0 * u * u));
  const double ratio = z < 1e-6 ? 0.5 : bessel_i(1.0, z) / z;
  return -4.0 * beta * beta * u * ratio / bessel_i(0.0, beta);
}

double place(Eigen::Index j, Eigen::Index n) {
  return static_cast<double>(j) / static_cast<double>(n) - 0.5;
}

}  // namespace

void WindowShape::validate() const {
  require_non_negative("window.parameter", parameter, "");
}

std::vector<double> WindowShape::cosines() const {
  switch (kind) {
    case WindowKind::hann:
      return {0.5, 0.5};
    case WindowKind::hamming:
      return {0.54, 0.46};
    case WindowKind::blackman:
      return {0.42, 0.5, 0.08};
    case WindowKind::blackman_harris:
      return {0.35875, 0.48829, 0.14128, 0.01168};
    case WindowKind::nuttall:
      return {0.355768, 0.487396, 0.144232, 0.012604};
    case WindowKind::flat_top:
      return {0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368};
    case WindowKind::gaussian:
    case WindowKind::kaiser:
      break;
  }
  return {};
}

Eigen::VectorXd window_samples(const WindowShape& shape, Eigen::Index n) {
  shape.validate();
  require_even(n);
  const std::vector<double> c = shape.cosines();
  const double parameter = parameter_of(shape);
  Eigen::VectorXd g(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double u = place(j, n);
    if (shape.kind == WindowKind::gaussian) {
      g(j) = gaussian(parameter, u);
    } else {
      g(j) = shape.kind == WindowKind::kaiser ? kaiser(parameter, u) : cosine_sum(c, u);
    }
  }
  return g;
}

Eigen::VectorXd window_derivative(const WindowShape& shape, Eigen::Index n, double sample_rate_hz) {
  shape.validate();
  require_even(n);
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  const std::vector<double> c = shape.cosines();
  const double parameter = parameter_of(shape);
  const double per_second = sample_rate_hz / static_cast<double>(n);  // du/dt
  Eigen::VectorXd slope(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double u = place(j, n);
    if (shape.kind == WindowKind::gaussian) {
      slope(j) = -u / (parameter * parameter) * gaussian(parameter, u) * per_second;
    } else {
      slope(j) = (shape.kind == WindowKind::kaiser ? kaiser_slope(parameter, u) : cosine_sum_slope(c, u)) * per_second;
    }
  }
  return slope;
}

}  // namespace robomill::signal
