#include "robomill/modal/fitting/fit_kernel.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace robomill::modal::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXcd all_poles(const Poles& poles) {
  VectorXcd lambda(poles.size());
  for (Index k = 0; k < poles.size(); ++k) lambda(k) = poles.pole(k);
  return lambda;
}

// The real and imaginary part of each pole's residue.
std::vector<Column> unit_columns(Index modes) {
  std::vector<Column> columns;
  for (Index k = 0; k < modes; ++k) {
    columns.push_back({k, 1.0, 2 * k});
    columns.push_back({k, Complex(0.0, 1.0), 2 * k + 1});
  }
  return columns;
}

// The real and imaginary part of each mode's right vector at one response.
std::vector<Column> linear_columns(const Poles& poles, Index excitation) {
  std::vector<Column> columns = unit_columns(poles.size());
  for (Column& column : columns) column.alpha *= poles.left(excitation, column.function);
  return columns;
}

// The parameters at one response.
std::vector<Column> parameter_columns(const Poles& poles, Index excitation, const Eigen::RowVectorXcd& right) {
  std::vector<Column> columns;
  const Index modes = poles.size();
  const Complex i(0.0, 1.0);
  Index parameter = 0;
  for (Index k = 0; k < modes; ++k) {
    const Complex residue = right(k) * poles.left(excitation, k);
    const double zeta = poles.zeta(k);
    const Complex by_zeta = poles.omega(k) * Complex(-1.0, -zeta / std::sqrt(1.0 - zeta * zeta));
    columns.push_back({modes + k, residue * poles.pole(k) / poles.omega(k), parameter++});
    columns.push_back({modes + k, residue * by_zeta, parameter++});
    for (Index j = 0; j < poles.left.rows(); ++j) {
      if (j == poles.gauge[static_cast<std::size_t>(k)]) continue;
      if (j == excitation) {
        columns.push_back({k, right(k), parameter});
        columns.push_back({k, i * right(k), parameter + 1});
      }
      parameter += 2;
    }
  }
  return columns;
}

// Least squares without some of its unknowns x: the cost rises by xᵀ C⁻¹ x, C their block of the inverse normal matrix.
void add_loss(VectorXd& loss, const ScaledCholesky& normal, const Eigen::RowVectorXcd& right) {
  const MatrixXd inverse = normal.solve(MatrixXd::Identity(2 * right.size(), 2 * right.size()));
  for (Index k = 0; k < right.size(); ++k) {
    const Eigen::Matrix2d block = inverse.block<2, 2>(2 * k, 2 * k);
    const Eigen::Vector2d x(right(k).real(), right(k).imag());
    if (block.determinant() > 0.0) loss(k) += x.dot(block.inverse() * x);
  }
}

}  // namespace

Kernel::Kernel(const FitData& data) : data_(data), lines_(data) {}

Evaluation Kernel::evaluate(const Poles& poles, bool derivatives) const {
  const Atoms basis(all_poles(poles), derivatives, lines_);
  std::vector<PairGram> grams;
  for (Index f = 0; f < lines_.entries; ++f) grams.emplace_back(basis, basis, f, lines_);
  Evaluation result;
  solve_linear(poles, basis, grams, result);
  subtract_model(poles, basis, result);
  if (derivatives) reduce(poles, basis, grams, result);
  return result;
}

void Kernel::solve_linear(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams,
                          Evaluation& into) const {
  const Index modes = poles.size();
  into.right = MatrixXcd::Zero(data_.responses, modes);
  for (Index i = 0; i < data_.responses; ++i) {
    MatrixXd normal = MatrixXd::Zero(2 * modes, 2 * modes);
    VectorXd rhs = VectorXd::Zero(2 * modes);
    for (std::size_t f = 0; f < data_.entries.size(); ++f) {
      const FitEntry& entry = data_.entries[f];
      if (entry.response != i) continue;
      const std::vector<Column> columns = linear_columns(poles, entry.excitation);
      grams[f].add(normal, columns, columns);
      add_product(rhs, basis.data, static_cast<Index>(f), columns);
    }
    const VectorXd solution = ScaledCholesky(normal).solve(rhs);
    for (Index k = 0; k < modes; ++k) into.right(i, k) = Complex(solution(2 * k), solution(2 * k + 1));
  }
}

void Kernel::subtract_model(const Poles& poles, const Atoms& basis, Evaluation& into) const {
  const Index points = basis.mu.size();
  const Index modes = poles.size();
  MatrixXcd amplitude(points, lines_.entries);
  for (Index f = 0; f < lines_.entries; ++f) {
    const FitEntry& entry = data_.entries[static_cast<std::size_t>(f)];
    for (Index k = 0; k < modes; ++k) {
      amplitude(k, f) = into.right(entry.response, k) * poles.left(entry.excitation, k);
      amplitude(modes + k, f) = std::conj(amplitude(k, f));
    }
  }
  const MatrixXd re = amplitude.real();
  const MatrixXd im = amplitude.imag();
  const MatrixXd model_re = basis.re.leftCols(points) * re - basis.im.leftCols(points) * im;
  const MatrixXd model_im = basis.re.leftCols(points) * im + basis.im.leftCols(points) * re;
  const Eigen::ArrayXd inverse_s2 = -lines_.omega.array().square().inverse();
  into.residual.resize(lines_.omega.size(), lines_.entries);
  into.mass.resize(lines_.entries);
  into.stiffness.resize(lines_.entries);
  into.cost = 0.0;
  for (Index f = 0; f < lines_.entries; ++f) {
    VectorXcd rest = data_.entries[static_cast<std::size_t>(f)].receptance;
    rest.real() -= model_re.col(f);
    rest.imag() -= model_im.col(f);
    const Eigen::Vector2cd tails = lines_.tail_inverse[static_cast<std::size_t>(f)] * lines_.tail_product(f, rest);
    into.stiffness(f) = tails(0);
    into.mass(f) = tails(1);
    rest.array() -= tails(0) + tails(1) * inverse_s2;
    into.cost += rest.cwiseAbs2().dot(lines_.columns.col(f));
    into.residual.col(f) = rest;
  }
}

void Kernel::reduce(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams,
                    Evaluation& into) const {
  const Index modes = poles.size();
  const Index unknowns = parameter_count(data_, modes);
  into.hessian = MatrixXd::Zero(unknowns, unknowns);
  into.gradient = VectorXd::Zero(unknowns);
  into.loss = VectorXd::Zero(modes);
  const MatrixXcd products = basis.paired(2 * modes, into.residual, lines_);
  for (Index i = 0; i < data_.responses; ++i) {
    MatrixXd normal = MatrixXd::Zero(2 * modes, 2 * modes);
    MatrixXd mixed = MatrixXd::Zero(2 * modes, unknowns);
    VectorXd slope = VectorXd::Zero(2 * modes);
    for (std::size_t f = 0; f < data_.entries.size(); ++f) {
      const FitEntry& entry = data_.entries[f];
      if (entry.response != i) continue;
      const std::vector<Column> linear = linear_columns(poles, entry.excitation);
      const std::vector<Column> free = parameter_columns(poles, entry.excitation, into.right.row(i));
      grams[f].add(normal, linear, linear);
      grams[f].add(mixed, linear, free);
      grams[f].add(into.hessian, free, free);
      add_product(slope, products, static_cast<Index>(f), linear);
      add_product(into.gradient, products, static_cast<Index>(f), free);
    }
    const ScaledCholesky factor(normal);
    add_loss(into.loss, factor, into.right.row(i));
    // The slope is zero but for rounding in the linear solution, which it takes out of the gradient.
    const MatrixXd eliminated = factor.solve(mixed);
    into.hessian -= mixed.transpose() * eliminated;
    into.gradient -= eliminated.transpose() * slope;
  }
}

// The modes that a candidate would join, with residues that are free for each entry.
struct Kernel::Present {
  Present(const Poles& poles, const Evaluation& base, const Lines& lines)
      : atoms(all_poles(poles), false, lines), columns(unit_columns(poles.size())) {
    const MatrixXcd products = atoms.paired(poles.size(), base.residual, lines);
    for (Index f = 0; f < lines.entries; ++f) {
      MatrixXd normal = MatrixXd::Zero(2 * poles.size(), 2 * poles.size());
      PairGram(atoms, atoms, f, lines).add(normal, columns, columns);
      factors.emplace_back(normal);
      slopes.emplace_back(VectorXd::Zero(2 * poles.size()));
      add_product(slopes.back(), products, f, columns);
    }
  }
  Atoms atoms;
  std::vector<Column> columns;
  std::vector<ScaledCholesky> factors;
  std::vector<VectorXd> slopes;
};

void Kernel::measure(std::vector<Candidate>& candidates, const Poles& poles, const Evaluation& base) const {
  constexpr std::size_t batch = 32;  // keeps the tables in the cache
  const Present present(poles, base, lines_);
  for (std::size_t begin = 0; begin < candidates.size(); begin += batch) {
    const std::size_t count = std::min(batch, candidates.size() - begin);
    measure_batch(std::span<Candidate>(candidates).subspan(begin, count), present, base);
  }
}

void Kernel::measure_batch(std::span<Candidate> batch, const Present& present, const Evaluation& base) const {
  const auto tried = static_cast<Index>(batch.size());
  Poles trial{.omega = VectorXd(tried), .zeta = VectorXd(tried), .left = {}, .gauge = {}};
  for (std::size_t c = 0; c < batch.size(); ++c) {
    trial.omega(static_cast<Index>(c)) = batch[c].omega;
    trial.zeta(static_cast<Index>(c)) = batch[c].zeta;
    batch[c].gain = 0.0;
    batch[c].residue = MatrixXcd::Zero(data_.responses, data_.excitations);
  }
  const Atoms added(all_poles(trial), false, lines_);
  const MatrixXcd products = added.paired(tried, base.residual, lines_);
  const std::vector<Column> columns = unit_columns(tried);
  for (Index f = 0; f < lines_.entries; ++f) {
    const auto entry = static_cast<std::size_t>(f);
    const PairGram own(added, added, f, lines_);
    MatrixXd mixed = MatrixXd::Zero(2 * present.atoms.modes(), 2 * tried);
    VectorXd rhs = VectorXd::Zero(2 * tried);
    PairGram(present.atoms, added, f, lines_).add(mixed, present.columns, columns);
    add_product(rhs, products, f, columns);
    const MatrixXd eliminated = present.factors[entry].solve(mixed);
    rhs -= eliminated.transpose() * present.slopes[entry];
    for (std::size_t c = 0; c < batch.size(); ++c) {
      const auto at = static_cast<Index>(2 * c);
      const Column& re = columns[2 * c];
      const Column& im = columns[2 * c + 1];
      Eigen::Matrix2d square;
      square << own(re, re), own(re, im), own(im, re), own(im, im);
      const double before = square.trace();
      square -= mixed.middleCols(at, 2).transpose() * eliminated.middleCols(at, 2);
      if (!(square.determinant() > 1e-16 * before * before)) continue;  // no other than those present
      const Eigen::Vector2d amplitude = square.inverse() * rhs.segment(at, 2);
      batch[c].gain += amplitude.dot(rhs.segment(at, 2));
      batch[c].residue(data_.entries[entry].response, data_.entries[entry].excitation) =
          Complex(amplitude(0), amplitude(1));
    }
  }
}

}  // namespace robomill::modal::detail
