#include "robomill/modal/fitting/fit_atoms.hpp"

#include <cmath>
#include <utility>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal::detail {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

Lines::Lines(const FitData& data) : omega(data.omega), entries(static_cast<Index>(data.entries.size())) {
  columns.resize(omega.size(), 4 * entries);
  const Eigen::ArrayXd inverse_s2 = -omega.array().square().inverse();
  for (Index f = 0; f < entries; ++f) {
    const FitEntry& entry = data.entries[static_cast<std::size_t>(f)];
    const Eigen::ArrayXd w2 = entry.weight.array().square();
    columns.col(f) = w2;
    columns.col(entries + f) = w2 * inverse_s2;
    Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
    if (data.residuals) {
      const double one = w2.sum();
      const double mixed = (w2 * inverse_s2).sum();
      const double square = (w2 * inverse_s2.square()).sum();
      inverse << square, -mixed, -mixed, one;
      inverse /= one * square - mixed * mixed;
    }
    tail_inverse.push_back(inverse);
    const Eigen::Vector2cd tails = inverse * tail_product(f, entry.receptance);
    const Eigen::ArrayXcd rest = entry.receptance.array() - tails(0) - tails(1) * inverse_s2;
    columns.col(2 * entries + f) = w2 * rest.real();
    columns.col(3 * entries + f) = w2 * rest.imag();
  }
}

Eigen::Vector2cd Lines::tail_product(Index entry, const VectorXcd& values) const {
  const VectorXd re = values.real();
  const VectorXd im = values.imag();
  return {Complex(columns.col(entry).dot(re), columns.col(entry).dot(im)),
          Complex(columns.col(entries + entry).dot(re), columns.col(entries + entry).dot(im))};
}

Atoms::Atoms(const VectorXcd& lambda, bool with_derivatives, const Lines& lines) {
  const Index points = 2 * lambda.size();
  const Index n = lines.omega.size();
  mu.resize(points);
  mu << lambda, lambda.conjugate();
  const Eigen::RowVectorXd decay = -mu.real().transpose();
  const Eigen::RowVectorXd decay2 = decay.cwiseAbs2();
  const Eigen::RowVectorXd centre = mu.imag().transpose();
  re.resize(n, with_derivatives ? 2 * points : points);
  im.resize(n, re.cols());
  for (Index l = 0; l < n; ++l) {
    auto re_l = re.row(l).head(points).array();
    auto im_l = im.row(l).head(points).array();
    im_l = centre.array() - lines.omega(l);
    re_l = (im_l.square() + decay2.array()).inverse();
    im_l *= re_l;
    re_l *= decay.array();
    if (!with_derivatives) continue;
    re.row(l).tail(points).array() = re_l.square() - im_l.square();
    im.row(l).tail(points).array() = 2.0 * re_l * im_l;
  }
  const Index f = lines.entries;
  MatrixXd from_re = re.transpose() * lines.columns.leftCols(2 * f);
  MatrixXd from_im = im.transpose() * lines.columns.leftCols(2 * f);
  sum.resize(re.cols(), f);
  tail.resize(re.cols(), f);
  sum.real() = from_re.leftCols(f);
  sum.imag() = from_im.leftCols(f);
  tail.real() = from_re.rightCols(f);
  tail.imag() = from_im.rightCols(f);
  from_re = re.leftCols(points).transpose() * lines.columns.rightCols(2 * f);
  from_im = im.leftCols(points).transpose() * lines.columns.rightCols(2 * f);
  MatrixXcd product(points, f);
  product.real() = from_re.leftCols(f) + from_im.rightCols(f);
  product.imag() = from_re.rightCols(f) - from_im.leftCols(f);
  data = product.topRows(modes()) + product.bottomRows(modes()).conjugate();
}

MatrixXcd Atoms::paired(Index functions, const MatrixXcd& values, const Lines& lines) const {
  const Index f = lines.entries;
  const Index count = 2 * functions;
  MatrixXd weighted(values.rows(), 2 * f);
  weighted.leftCols(f) = lines.columns.leftCols(f).cwiseProduct(values.real());
  weighted.rightCols(f) = lines.columns.leftCols(f).cwiseProduct(values.imag());
  const MatrixXd from_re = re.leftCols(count).transpose() * weighted;
  const MatrixXd from_im = im.leftCols(count).transpose() * weighted;
  MatrixXcd product(count, f);
  product.real() = from_re.leftCols(f) + from_im.rightCols(f);
  product.imag() = from_re.rightCols(f) - from_im.leftCols(f);
  MatrixXcd result(functions, f);
  for (Index a = 0; a < functions; ++a) result.row(a) = product.row(own(a)) + product.row(own(a) + modes()).conjugate();
  return result;
}

namespace {

// aᴴ weight² b of one entry, tails projected out.
MatrixXcd gram(const Atoms& a, const Atoms& b, Index entry, const Eigen::Matrix2d& tail_inverse) {
  const Index points_a = a.mu.size();
  const Index points_b = b.mu.size();
  MatrixXcd g(a.sum.rows(), b.sum.rows());
  for (Index q = 0; q < points_b; ++q) {
    for (Index p = 0; p < points_a; ++p) {
      const Complex inverse = 1.0 / (b.mu(q) + std::conj(a.mu(p)));
      const Complex value = -(b.sum(q, entry) + std::conj(a.sum(p, entry))) * inverse;
      g(p, q) = value;
      const Complex by_a = a.derivatives() ? -std::conj(a.sum(points_a + p, entry)) * inverse : 0.0;
      const Complex by_b = b.derivatives() ? -b.sum(points_b + q, entry) * inverse : 0.0;
      if (a.derivatives()) g(points_a + p, q) = by_a - value * inverse;
      if (b.derivatives()) g(p, points_b + q) = by_b - value * inverse;
      if (a.derivatives() && b.derivatives()) {
        g(points_a + p, points_b + q) = (2.0 * value * inverse - by_a - by_b) * inverse;
      }
    }
  }
  MatrixXcd tails_a(a.sum.rows(), 2);
  MatrixXcd tails_b(2, b.sum.rows());
  tails_a << a.sum.col(entry).conjugate(), a.tail.col(entry).conjugate();
  tails_b << b.sum.col(entry).transpose(), b.tail.col(entry).transpose();
  g -= tails_a * (tail_inverse * tails_b);
  return g;
}

}  // namespace

PairGram::PairGram(const Atoms& a, const Atoms& b, Index entry, const Lines& lines) {
  const MatrixXcd g = gram(a, b, entry, lines.tail_inverse[static_cast<std::size_t>(entry)]);
  same.resize(g.rows() / 2, g.cols() / 2);
  mixed.resize(same.rows(), same.cols());
  for (Index q = 0; q < same.cols(); ++q) {
    const Index column = b.own(q);
    for (Index p = 0; p < same.rows(); ++p) {
      const Index row = a.own(p);
      same(p, q) = g(row, column) + std::conj(g(row + a.modes(), column + b.modes()));
      mixed(p, q) = g(row, column + b.modes()) + std::conj(g(row + a.modes(), column));
    }
  }
}

void PairGram::add(MatrixXd& into, const std::vector<Column>& rows, const std::vector<Column>& columns) const {
  for (const Column& b : columns) {
    for (const Column& a : rows) into(a.unknown, b.unknown) += (*this)(a, b);
  }
}

void add_product(VectorXd& into, const MatrixXcd& paired, Index entry, const std::vector<Column>& columns) {
  for (const Column& a : columns) into(a.unknown) += (std::conj(a.alpha) * paired(a.function, entry)).real();
}

ScaledCholesky::ScaledCholesky(const MatrixXd& gram) : scale_(gram.rows()) {
  constexpr double smallest_pivot = 1e-14;  // of a Gram matrix with ones on its diagonal: below it rounding rules
  for (Index i = 0; i < gram.rows(); ++i) scale_(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
  MatrixXd scaled = scale_.asDiagonal() * gram * scale_.asDiagonal();
  for (double ridge = smallest_pivot * static_cast<double>(gram.rows());; ridge *= 100.0) {
    scaled.diagonal().setConstant(1.0 + ridge);
    linear_algebra::Cholesky cholesky = linear_algebra::cholesky(scaled);
    if (!cholesky.positive_definite && ridge < 1.0) continue;
    factor_ = std::move(cholesky.lower);
    return;
  }
}

MatrixXd ScaledCholesky::solve(const MatrixXd& rhs) const {
  MatrixXd x = scale_.asDiagonal() * rhs;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  return scale_.asDiagonal() * x;
}

}  // namespace robomill::modal::detail
