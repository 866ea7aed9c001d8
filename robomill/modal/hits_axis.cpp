#include "robomill/modal/hits_axis.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>

#include "robomill/base/parallel.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index reach = 6;  // lines on each side
constexpr Index points = 2 * reach + 1;
using Values = Eigen::Matrix<Complex, points, 1>;

struct Local {
  Complex value = 0.0;                                        // at the place asked for
  double residual = std::numeric_limits<double>::infinity();  // sum of squares per degree of freedom
};

// Σ_p c_p x^p, p = 0 … 3.
Local cubic(const Values& x, const Values& h, const Eigen::Matrix<double, points, 1>& weight, Complex at) {
  Eigen::Matrix<Complex, points, 4> a;
  a.col(0).setOnes();
  for (Index p = 1; p < 4; ++p) a.col(p) = a.col(p - 1).cwiseProduct(x);
  const Eigen::Matrix<Complex, points, 4> aw = weight.asDiagonal() * a;
  const Values hw = weight.asDiagonal() * h;
  const Eigen::Matrix<Complex, 4, 1> c = aw.householderQr().solve(hw);
  return {.value = c(0) + at * (c(1) + at * (c(2) + at * c(3))),
          .residual = (aw * c - hw).squaredNorm() / (weight.sum() - 4.0)};
}

// (b0 + b1 x + b2 x²) / (1 + a1 x + a2 x²), linearised and weighted by the last denominator [Sanathanan1963].
Local rational(const Values& x, const Values& h, const Eigen::Matrix<double, points, 1>& weight, Complex at) {
  Values denominator = Values::Ones();
  Eigen::Matrix<Complex, 5, 1> c;
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix<Complex, points, 5> a;
    a.col(0).setOnes();
    a.col(1) = x;
    a.col(2) = x.cwiseProduct(x);
    a.col(3) = -h.cwiseProduct(a.col(1));
    a.col(4) = -h.cwiseProduct(a.col(2));
    const Values scale = weight.cast<Complex>().cwiseQuotient(denominator);
    const Eigen::Matrix<Complex, points, 5> aw = scale.asDiagonal() * a;
    c = aw.colPivHouseholderQr().solve(scale.cwiseProduct(h).eval());
    denominator = Values::Ones() + c(3) * x + c(4) * x.cwiseProduct(x);
  }
  const Values fitted = (Values::Constant(c(0)) + c(1) * x + c(2) * x.cwiseProduct(x)).cwiseQuotient(denominator);
  const double residual = (weight.asDiagonal() * (fitted - h)).squaredNorm() / (weight.sum() - 5.0);
  // A pole between the lines and the place asked for would belong to a mode that grows: noise. Then there is no answer.
  const Complex root = std::sqrt(c(3) * c(3) - 4.0 * c(4));
  for (const Complex pole : {(-c(3) + root) / (2.0 * c(4)), (-c(3) - root) / (2.0 * c(4))}) {
    if (std::abs(pole.imag()) < 1.0 && pole.real() > at.real() && pole.real() < -at.real()) return {};
  }
  return {.value = (c(0) + at * (c(1) + at * c(2))) / (1.0 + at * (c(3) + at * c(4))), .residual = residual};
}

Complex continued(const Eigen::VectorXcd& lines, Index k, double decay_in_reaches) {
  Values x;
  Values h;
  Eigen::Matrix<double, points, 1> weight;
  const Index centre = std::min(k, lines.size() - 1 - reach);
  for (Index j = 0; j < points; ++j) {
    const Index line = centre - reach + j;
    x(j) = Complex(0.0, static_cast<double>(line - k) / static_cast<double>(reach));
    h(j) = line < 0 ? std::conj(lines(-line)) : lines(line);
    weight(j) = line == 0 ? 0.0 : 1.0;
  }
  const Complex at(-decay_in_reaches, 0.0);
  const double scale = h.cwiseAbs().maxCoeff();
  if (scale == 0.0) return 0.0;
  h /= scale;
  const Local smooth = cubic(x, h, weight, at);
  const Local resonant = rational(x, h, weight, at);
  // The smoother one must be worse by more than chance makes it; it carries noise less far.
  return smooth.residual > 3.0 * resonant.residual ? scale * resonant.value : scale * smooth.value;
}

}  // namespace

Eigen::VectorXcd without_decay(const Eigen::VectorXcd& lines, double spacing_rad_per_s, double decay_per_s) {
  Eigen::VectorXcd moved = lines;
  const double decay_in_reaches = decay_per_s / (spacing_rad_per_s * static_cast<double>(reach));
  parallel_for(static_cast<std::size_t>(lines.size() - 1), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index k = static_cast<Index>(i) + 1;
      moved(k) = continued(lines, k, decay_in_reaches);
    }
  });
  return moved;
}

}  // namespace robomill::modal
