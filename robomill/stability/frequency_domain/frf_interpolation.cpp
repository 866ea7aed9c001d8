#include "robomill/stability/frequency_domain/frf_interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// Weights of the divided difference of order points.size() - 1, scaled to norm 1.
Eigen::VectorXd divided_difference(const Eigen::VectorXd& points) {
  Eigen::VectorXd weights(points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    double product = 1.0;
    for (Eigen::Index j = 0; j < points.size(); ++j) {
      if (j != i) product *= points(i) - points(j);
    }
    weights(i) = 1.0 / product;
  }
  return weights / weights.norm();
}

/// Whether x is where a structure's pole can be: decaying (Im > 0) and wide enough to show between lines, or far away.
bool plausible(Complex root, double spacing) {
  const double along = std::max(std::abs(root.real()) - 1.0, 0.0);
  return root.imag() >= 0.15 * spacing || std::hypot(along, root.imag()) > 1.0;
}

bool plausible(const std::array<Complex, 2>& d, double spacing) {
  if (d[1] == 0.0) return d[0] == 0.0 || plausible(-1.0 / d[0], spacing);
  const Complex root = std::sqrt(d[0] * d[0] - 4.0 * d[1]);
  return plausible((-d[0] + root) / (2.0 * d[1]), spacing) && plausible((-d[0] - root) / (2.0 * d[1]), spacing);
}

Eigen::Matrix2cd matrix(const Eigen::RowVector4cd& entries) {
  Eigen::Matrix2cd h;
  h << entries(0), entries(2), entries(1), entries(3);
  return h;
}

}  // namespace

FrfInterpolation::FrfInterpolation(Eigen::VectorXd frequency_rad_per_s, Lines lines)
    : frequency_(std::move(frequency_rad_per_s)), lines_(std::move(lines)) {
  pieces_.reserve(static_cast<std::size_t>(frequency_.size() - 1));
  for (Eigen::Index i = 0; i + 1 < frequency_.size(); ++i) pieces_.push_back(piece(i));
  find_continuation();
}

FrfInterpolation::Piece FrfInterpolation::piece(Eigen::Index line) const {
  const Eigen::Index start = std::clamp<Eigen::Index>(line - (window / 2 - 1), 0, frequency_.size() - window);
  Piece p;
  p.first = std::clamp<Eigen::Index>(line - (through / 2 - 1), 0, frequency_.size() - through);
  const Eigen::VectorXd lines = frequency_.segment(start, window);
  p.middle = 0.5 * (lines(0) + lines(window - 1));
  p.scale = 0.5 * (lines(window - 1) - lines(0));
  const Eigen::VectorXd x = (lines.array() - p.middle) / p.scale;
  const double spacing = (frequency_(line + 1) - frequency_(line)) / p.scale;

  // Two divided differences of order 6, of H, x H and x² H: the first must be outweighed by the others.
  Eigen::MatrixXcd misses(8, 3);
  for (Eigen::Index shift = 0; shift < 2; ++shift) {
    const Eigen::VectorXd weights = divided_difference(x.segment(shift, window - 1));
    for (Eigen::Index power = 0; power < 3; ++power) {
      const Eigen::VectorXd at = weights.array() * x.segment(shift, window - 1).array().pow(power);
      misses.block(4 * shift, power, 4, 1) =
          (at.transpose() * lines_.middleRows(start + shift, window - 1)).transpose();
    }
  }
  const double size = lines_.middleRows(start, window).norm();
  const Eigen::VectorXcd miss = -misses.col(0);
  double least = miss.norm();
  for (Eigen::Index degree = 1; degree <= 2 && least > 1e-13 * size; ++degree) {
    const Eigen::MatrixXcd columns = misses.middleCols(1, degree);
    const Eigen::VectorXcd found = linear_algebra::least_squares_with_pivots(columns, miss);
    const double left = (columns * found - miss).norm();
    const std::array<Complex, 2> d = {found(0), degree == 2 ? found(1) : 0.0};
    if (!(left < least / 3.0) || !found.allFinite() || !plausible(d, spacing)) continue;
    least = left;
    p.denominator = d;
  }
  for (Eigen::Index i = 0; i < through; ++i) {
    double product = 1.0;
    for (Eigen::Index j = 0; j < through; ++j) {
      if (j != i) product *= (frequency_(p.first + i) - frequency_(p.first + j)) / p.scale;
    }
    p.weight[static_cast<std::size_t>(i)] = 1.0 / product;
  }
  return p;
}

void FrfInterpolation::find_continuation() {
  const Eigen::Index n = frequency_.size();
  const Eigen::VectorXd size = lines_.rowwise().norm();
  const Eigen::Index quarter = std::max<Eigen::Index>(window, n / 4);
  const bool peak = size.tail(quarter).maxCoeff() > 4.0 * size.tail(std::max<Eigen::Index>(4, n / 20)).mean();
  const Eigen::Index count = peak ? std::max<Eigen::Index>(4, n / 10) : quarter;
  if (frequency_(n - count) == 0.0) return;
  const Lines top = lines_.bottomRows(count);
  // Real and imaginary parts as equations of their own, for the coefficients are real.
  Eigen::MatrixXd powers(2 * count, 4);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Complex step = high() / Complex(0.0, frequency_(n - count + i));
    Complex power = step;
    for (Eigen::Index k = 0; k < 4; ++k) {
      powers(i, k) = power.real();
      powers(count + i, k) = power.imag();
      power *= step;
    }
  }
  if (peak) {
    for (const Eigen::Index k : {0, 2, 3}) powers.col(k).setZero();
  }
  Eigen::MatrixXd values(2 * count, 4);
  values << top.real(), top.imag();
  const Eigen::Matrix4d fitted = linear_algebra::least_squares_with_pivots(powers, values);
  if (fitted.allFinite() && (powers * fitted - values).norm() <= 0.5 * values.norm()) above_ = fitted;
}

Eigen::Matrix2d FrfInterpolation::first_moment() const {
  return matrix(above_.row(0).cast<Complex>() * high()).real();
}

Eigen::Matrix2cd FrfInterpolation::at(double frequency_rad_per_s) const {
  const double omega = std::abs(frequency_rad_per_s);
  Eigen::RowVector4cd value;
  if (omega < low()) {
    for (Eigen::Index e = 0; e < 4; ++e) {
      value(e) = Complex(lines_(0, e).real(), lines_(0, e).imag() * omega / low());
    }
  } else if (omega > high()) {
    const Complex step = high() / Complex(0.0, omega);
    Complex power = step;
    value.setZero();
    for (Eigen::Index k = 0; k < 4; ++k) {
      value += power * above_.row(k).cast<Complex>();
      power *= step;
    }
  } else {
    const double* const begin = frequency_.data();
    const double* const after = std::upper_bound(begin, begin + frequency_.size(), omega);
    const Eigen::Index line = std::clamp<Eigen::Index>(after - begin - 1, 0, frequency_.size() - 2);
    const Piece& p = pieces_[static_cast<std::size_t>(line)];
    const auto d = [&p](double x) { return 1.0 + x * (p.denominator[0] + x * p.denominator[1]); };
    const double x = (omega - p.middle) / p.scale;
    value.setZero();
    double sum = 0.0;
    for (Eigen::Index i = 0; i < through; ++i) {
      const double xi = (frequency_(p.first + i) - p.middle) / p.scale;
      if (x == xi) {
        value = lines_.row(p.first + i) * d(xi);
        sum = 1.0;
        break;
      }
      const double w = p.weight[static_cast<std::size_t>(i)] / (x - xi);
      sum += w;
      value += (w * d(xi)) * lines_.row(p.first + i);
    }
    value /= sum * d(x);
  }
  const Eigen::Matrix2cd h = matrix(value);
  return frequency_rad_per_s < 0.0 ? Eigen::Matrix2cd(h.conjugate()) : h;
}

}  // namespace robomill::stability::detail
