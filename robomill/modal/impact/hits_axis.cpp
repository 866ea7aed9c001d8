#include "robomill/modal/impact/hits_axis.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index reach = 6;  // lines on each side
constexpr Index points = 2 * reach + 1;
constexpr Index most_unknowns = 7;
using Values = Eigen::Matrix<Complex, points, 1>;
using Weights = Eigen::Matrix<double, points, 1>;
// Sizes known while running alone: a decomposition unrolled for each of them takes a minute to compile.
using Basis = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, 0, points, most_unknowns>;
using Unknowns = Eigen::Matrix<Complex, Eigen::Dynamic, 1, 0, most_unknowns, 1>;

struct Local {
  Complex value = 0.0;    // at the place asked for
  double residual = 0.0;  // sum of squares per degree of freedom; infinite where there is no answer
};

// Whether 1 + Σ_p a_p x^p has no root with |Im x| < 1 and `limit` < Re x < -limit.
bool poles_stay_away(const Eigen::Ref<const Eigen::VectorXcd>& a, double limit) {
  const Index degree = a.size();
  // The companion matrix of the reversed polynomial has the inverses of the roots.
  Eigen::MatrixXcd companion = Eigen::MatrixXcd::Zero(degree, degree);
  companion.row(0) = -a.transpose();
  if (degree > 1) companion.diagonal(-1).setOnes();
  const Eigen::VectorXcd inverses = linear_algebra::eigenvalues(companion);
  for (const Complex inverse : inverses) {
    const Complex root = 1.0 / inverse;
    if (std::abs(root.imag()) < 1.0 && root.real() > limit && root.real() < -limit) return false;
  }
  return true;
}

// Σ_p c_p x^p, p = 0 … 3.
Local cubic(const Values& x, const Values& h, const Weights& weight, Complex at) {
  Basis a(points, 4);
  a.col(0).setOnes();
  for (Index p = 1; p < 4; ++p) a.col(p) = a.col(p - 1).cwiseProduct(x);
  const Basis aw = weight.asDiagonal() * a;
  const Values hw = weight.asDiagonal() * h;
  const Unknowns c = aw.householderQr().solve(hw);
  return {.value = c(0) + at * (c(1) + at * (c(2) + at * c(3))),
          .residual = (aw * c - hw).squaredNorm() / (weight.sum() - 4.0)};
}

// Σ_p b_p x^p / (1 + Σ_p a_p x^p), p up to `above` and `below` <= above, linearised and weighted by the denominator of
// the round before [Sanathanan1963].
Local rational(const Values& x, const Values& h, const Weights& weight, Complex at, Index above, Index below) {
  const Index unknowns = above + below + 1;
  Basis powers(points, above + 1);
  Unknowns powers_at(above + 1);
  powers.col(0).setOnes();
  powers_at(0) = 1.0;
  for (Index p = 1; p <= above; ++p) {
    powers.col(p) = powers.col(p - 1).cwiseProduct(x);
    powers_at(p) = powers_at(p - 1) * at;
  }
  Basis a(points, unknowns);
  a.leftCols(above + 1) = powers;
  a.rightCols(below) = -(h.asDiagonal() * powers.middleCols(1, below));
  Values denominator = Values::Ones();
  Unknowns c;
  for (int round = 0; round < 3; ++round) {
    const Values scale = weight.cast<Complex>().cwiseQuotient(denominator);
    const Basis aw = scale.asDiagonal() * a;
    c = aw.colPivHouseholderQr().solve(scale.cwiseProduct(h).eval());
    denominator = Values::Ones() + powers.middleCols(1, below) * c.tail(below);
  }
  // A pole between the lines and the place asked for would belong to a mode that grows: noise.
  if (!poles_stay_away(c.tail(below), at.real())) {
    return {.value = 0.0, .residual = std::numeric_limits<double>::infinity()};
  }
  const Values fitted = (powers * c.head(above + 1)).cwiseQuotient(denominator);
  const Complex top = (powers_at.transpose() * c.head(above + 1)).value();
  const Complex bottom = 1.0 + (powers_at.segment(1, below).transpose() * c.tail(below)).value();
  return {
      .value = top / bottom,
      .residual = (weight.asDiagonal() * (fitted - h)).squaredNorm() / (weight.sum() - static_cast<double>(unknowns))};
}

Complex continued(const Eigen::VectorXcd& lines, Index k, double decay_in_reaches) {
  Values x;
  Values h;
  Weights weight;
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
  // More unknowns follow noise more closely and carry it further: they must earn their place.
  Local best = cubic(x, h, weight, at);
  const auto prefer = [&best](const Local& other, double factor) {
    if (factor * other.residual < best.residual) best = {.value = other.value, .residual = factor * other.residual};
  };
  prefer(rational(x, h, weight, at, 2, 1), 1.0);
  prefer(rational(x, h, weight, at, 2, 2), 3.0);
  prefer(rational(x, h, weight, at, 3, 3), 30.0);
  return scale * best.value;
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
