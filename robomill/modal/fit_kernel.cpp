#include "robomill/modal/fit_kernel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace robomill::modal::detail {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

constexpr double smallest_pivot = 1e-14;  // of a Gram matrix with ones on its diagonal: below it rounding rules

Complex pole_of(double omega, double zeta) {
  return omega * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
}

// Solves symmetric positive systems whose unknowns have very different sizes; a dependent unknown gets about zero.
class ScaledCholesky {
 public:
  explicit ScaledCholesky(const MatrixXd& gram) : scale_(gram.rows()) {
    for (Index i = 0; i < gram.rows(); ++i) scale_(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
    MatrixXd scaled = scale_.asDiagonal() * gram * scale_.asDiagonal();
    scaled.diagonal().array() = 1.0 + smallest_pivot * static_cast<double>(gram.rows());
    factor_.compute(scaled);
  }
  [[nodiscard]] MatrixXd solve(const MatrixXd& rhs) const {
    return scale_.asDiagonal() * factor_.solve(MatrixXd(scale_.asDiagonal() * rhs));
  }

 private:
  VectorXd scale_;
  Eigen::LDLT<MatrixXd> factor_;
};

}  // namespace

// A real column α φ_a + conj(α) φ̃_a of the model's Jacobian, φ_a = 1/(s - λ) or its derivative, φ̃_a the same of the
// conjugate pole.
struct Column {
  Index atom;
  Complex alpha;
  Index unknown;
};

// Inner products of such columns: Re(conj(α) (β same(a, b) + conj(β) mixed(a, b))).
struct PairGram {
  MatrixXcd same, mixed;
  PairGram(const MatrixXcd& gram, Index modes_a, Index modes_b)
      : same(gram.rows() / 2, gram.cols() / 2), mixed(gram.rows() / 2, gram.cols() / 2) {
    for (Index c = 0; c < same.cols(); ++c) {
      const Index pole_c = own(c, modes_b);
      for (Index r = 0; r < same.rows(); ++r) {
        const Index pole_r = own(r, modes_a);
        same(r, c) = gram(pole_r, pole_c) + std::conj(gram(pole_r + modes_a, pole_c + modes_b));
        mixed(r, c) = gram(pole_r, pole_c + modes_b) + std::conj(gram(pole_r + modes_a, pole_c));
      }
    }
  }
  // Where the function of a pole stands among the atoms; its conjugate's stands `modes` after it.
  static Index own(Index atom, Index modes) { return atom < modes ? atom : modes + atom; }

  [[nodiscard]] double operator()(const Column& a, const Column& b) const {
    return (std::conj(a.alpha) * (b.alpha * same(a.atom, b.atom) + std::conj(b.alpha) * mixed(a.atom, b.atom))).real();
  }
};

namespace {

// φᴴ values + conj(φ̃ᴴ values), which gives the columns' products with `values`.
VectorXcd paired(const VectorXcd& product, Index modes) {
  VectorXcd result(product.size() / 2);
  for (Index a = 0; a < result.size(); ++a) {
    const Index pole = PairGram::own(a, modes);
    result(a) = product(pole) + std::conj(product(pole + modes));
  }
  return result;
}

void add_gram(MatrixXd& into, const PairGram& gram, const std::vector<Column>& rows,
              const std::vector<Column>& columns) {
  for (const Column& b : columns) {
    for (const Column& a : rows) into(a.unknown, b.unknown) += gram(a, b);
  }
}

void add_product(VectorXd& into, const VectorXcd& product, const std::vector<Column>& columns) {
  for (const Column& a : columns) into(a.unknown) += (std::conj(a.alpha) * product(a.atom)).real();
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

std::vector<Column> linear_columns(const Poles& poles, Index excitation) {
  std::vector<Column> columns;
  const Complex i(0.0, 1.0);
  for (Index k = 0; k < poles.size(); ++k) {
    const Complex left = poles.left(excitation, k);
    columns.push_back({k, left, 2 * k});
    columns.push_back({k, i * left, 2 * k + 1});
  }
  return columns;
}

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

}  // namespace

// The basis functions and their sums over the lines: φ = 1/(s - μ) and, if wanted, φ' = 1/(s - μ)², μ the poles λ and
// then their conjugates.
struct Atoms {
  VectorXcd mu;         // length 2m
  MatrixXd re, im;      // n x atoms: φ, then φ'
  MatrixXcd sum, tail;  // atoms x entries: Σ weight² φ and Σ weight² φ / s²
  [[nodiscard]] Index modes() const { return mu.size() / 2; }
  [[nodiscard]] bool derivatives() const { return re.cols() > mu.size(); }
};

namespace {

Atoms make_atoms(const VectorXcd& lambda, bool derivatives, const VectorXd& omega, const MatrixXd& weights) {
  const Index points = 2 * lambda.size();
  Atoms a;
  a.mu.resize(points);
  a.mu << lambda, lambda.conjugate();
  a.re.resize(omega.size(), derivatives ? 2 * points : points);
  a.im.resize(omega.size(), a.re.cols());
  for (Index p = 0; p < points; ++p) {
    const double decay = -a.mu(p).real();
    const Eigen::ArrayXd detuning = omega.array() - a.mu(p).imag();
    const Eigen::ArrayXd size2 = (detuning.square() + decay * decay).inverse();
    a.re.col(p) = decay * size2;
    a.im.col(p) = -detuning * size2;
    if (!derivatives) continue;
    a.re.col(points + p) = a.re.col(p).array().square() - a.im.col(p).array().square();
    a.im.col(points + p) = 2.0 * a.re.col(p).array() * a.im.col(p).array();
  }
  const MatrixXd re = a.re.transpose() * weights;
  const MatrixXd im = a.im.transpose() * weights;
  const Index entries = weights.cols() / 2;
  a.sum.resize(re.rows(), entries);
  a.tail.resize(re.rows(), entries);
  a.sum.real() = re.leftCols(entries);
  a.sum.imag() = im.leftCols(entries);
  a.tail.real() = re.rightCols(entries);
  a.tail.imag() = im.rightCols(entries);
  return a;
}

// aᴴ weight² b of one entry from the sums of a and of b, with the tails 1 and 1/s² projected out.
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

// φᴴ weight² values + conj(φ̃ᴴ weight² values) of the first `functions` functions (m: φ, 2m: φ'), from which follow the
// columns' products with `values`.
VectorXcd paired_product(const Atoms& of, Index functions, const VectorXd& weight2, const VectorXcd& values) {
  const Index count = 2 * functions;
  MatrixXd weighted(values.size(), 2);
  weighted.col(0) = weight2.array() * values.real().array();
  weighted.col(1) = weight2.array() * values.imag().array();
  const MatrixXd re = of.re.leftCols(count).transpose() * weighted;
  const MatrixXd im = of.im.leftCols(count).transpose() * weighted;
  VectorXcd product(count);
  product.real() = re.col(0) + im.col(1);
  product.imag() = re.col(1) - im.col(0);
  return paired(product, of.modes());
}

}  // namespace

std::complex<double> Poles::pole(Index k) const {
  return pole_of(omega(k), zeta(k));
}

void Poles::fix_gauge() {
  gauge.assign(static_cast<std::size_t>(size()), 0);
  for (Index k = 0; k < size(); ++k) {
    Index& row = gauge[static_cast<std::size_t>(k)];
    left.col(k).cwiseAbs().maxCoeff(&row);
    if (left(row, k) != 0.0) left.col(k) /= Complex(left(row, k));
    left(row, k) = 1.0;
  }
}

Poles Poles::without(Index k) const {
  Poles rest{.omega = VectorXd(size() - 1),
             .zeta = VectorXd(size() - 1),
             .left = MatrixXcd(left.rows(), size() - 1),
             .gauge = gauge};
  rest.gauge.erase(rest.gauge.begin() + k);
  for (Index from = 0, to = 0; from < size(); ++from) {
    if (from == k) continue;
    rest.omega(to) = omega(from);
    rest.zeta(to) = zeta(from);
    rest.left.col(to) = left.col(from);
    ++to;
  }
  return rest;
}

Poles Poles::with(double new_omega, double new_zeta, const VectorXcd& new_left) const {
  Poles more = *this;
  more.omega.conservativeResize(size() + 1);
  more.zeta.conservativeResize(size() + 1);
  more.left.conservativeResize(new_left.size(), size() + 1);
  more.omega(size()) = new_omega;
  more.zeta(size()) = new_zeta;
  more.left.col(size()) = new_left;
  more.fix_gauge();
  return more;
}

Index parameter_count(const FitData& data, Index modes) {
  return 2 * data.excitations * modes;
}

VectorXd to_parameters(const Poles& poles) {
  VectorXd parameters(2 * poles.left.rows() * poles.size());
  Index next = 0;
  for (Index k = 0; k < poles.size(); ++k) {
    parameters(next++) = poles.omega(k);
    parameters(next++) = poles.zeta(k);
    for (Index j = 0; j < poles.left.rows(); ++j) {
      if (j == poles.gauge[static_cast<std::size_t>(k)]) continue;
      parameters(next++) = poles.left(j, k).real();
      parameters(next++) = poles.left(j, k).imag();
    }
  }
  return parameters;
}

Poles from_parameters(const VectorXd& parameters, const Poles& shape) {
  Poles poles = shape;
  Index next = 0;
  for (Index k = 0; k < poles.size(); ++k) {
    poles.omega(k) = parameters(next++);
    poles.zeta(k) = parameters(next++);
    for (Index j = 0; j < poles.left.rows(); ++j) {
      if (j == shape.gauge[static_cast<std::size_t>(k)]) continue;
      poles.left(j, k) = Complex(parameters(next), parameters(next + 1));
      next += 2;
    }
  }
  return poles;
}

Kernel::Kernel(const FitData& data) : data_(data) {
  const auto entries = static_cast<Index>(data.entries.size());
  weights_.resize(data.omega.size(), 2 * entries);
  const Eigen::ArrayXd inverse_s2 = -data.omega.array().square().inverse();
  for (Index f = 0; f < entries; ++f) {
    const Eigen::ArrayXd w2 = data.entries[static_cast<std::size_t>(f)].weight.array().square();
    weights_.col(f) = w2;
    weights_.col(entries + f) = w2 * inverse_s2;
    Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
    if (data.residuals) {
      const double one = w2.sum();
      const double mixed = (w2 * inverse_s2).sum();
      const double square = (w2 * inverse_s2.square()).sum();
      inverse << square, -mixed, -mixed, one;
      inverse /= one * square - mixed * mixed;
    }
    tail_inverse_.push_back(inverse);
  }
}

// (1, 1/s²)ᴴ weight² values.
Eigen::Vector2cd Kernel::tail_product(Index entry, const VectorXcd& values) const {
  const Index entries = weights_.cols() / 2;
  return {values.cwiseProduct(weights_.col(entry)).sum(), values.cwiseProduct(weights_.col(entries + entry)).sum()};
}

Evaluation Kernel::evaluate(const Poles& poles, bool derivatives) const {
  VectorXcd lambda(poles.size());
  for (Index k = 0; k < poles.size(); ++k) lambda(k) = poles.pole(k);
  const Atoms basis = make_atoms(lambda, derivatives, data_.omega, weights_);
  std::vector<PairGram> grams;
  for (std::size_t f = 0; f < data_.entries.size(); ++f) {
    grams.emplace_back(gram(basis, basis, static_cast<Index>(f), tail_inverse_[f]), poles.size(), poles.size());
  }
  Evaluation result;
  solve_linear(poles, basis, grams, result);
  if (derivatives) reduce(poles, basis, grams, result);
  return result;
}

void Kernel::solve_linear(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams,
                          Evaluation& into) const {
  const Index modes = poles.size();
  into.right = MatrixXcd::Zero(data_.responses, modes);
  into.mass = into.stiffness = VectorXcd::Zero(static_cast<Index>(data_.entries.size()));
  for (Index i = 0; i < data_.responses; ++i) {
    MatrixXd normal = MatrixXd::Zero(2 * modes, 2 * modes);
    VectorXd rhs = VectorXd::Zero(2 * modes);
    for (std::size_t f = 0; f < data_.entries.size(); ++f) {
      const FitEntry& entry = data_.entries[f];
      if (entry.response != i) continue;
      const auto index = static_cast<Index>(f);
      const Eigen::Vector2cd tails = tail_inverse_[f] * tail_product(index, entry.receptance);
      const VectorXcd without_tails = entry.receptance.array() - tails(0) + tails(1) / data_.omega.array().square();
      const std::vector<Column> columns = linear_columns(poles, entry.excitation);
      add_gram(normal, grams[f], columns, columns);
      add_product(rhs, paired_product(basis, modes, weights_.col(index), without_tails), columns);
    }
    const VectorXd solution = ScaledCholesky(normal).solve(rhs);
    for (Index k = 0; k < modes; ++k) into.right(i, k) = Complex(solution(2 * k), solution(2 * k + 1));
  }
  into.cost = 0.0;
  for (std::size_t f = 0; f < data_.entries.size(); ++f) subtract_model(poles, basis, f, into);
}

void Kernel::subtract_model(const Poles& poles, const Atoms& basis, std::size_t f, Evaluation& into) const {
  const FitEntry& entry = data_.entries[f];
  const auto index = static_cast<Index>(f);
  const Index points = basis.mu.size();
  VectorXcd amplitude(points);
  const VectorXcd residue = into.right.row(entry.response).cwiseProduct(poles.left.row(entry.excitation)).transpose();
  amplitude << residue, residue.conjugate();
  VectorXcd rest = entry.receptance;
  rest.real() -= basis.re.leftCols(points) * amplitude.real() - basis.im.leftCols(points) * amplitude.imag();
  rest.imag() -= basis.re.leftCols(points) * amplitude.imag() + basis.im.leftCols(points) * amplitude.real();
  const Eigen::Vector2cd tails = tail_inverse_[f] * tail_product(index, rest);
  into.stiffness(index) = tails(0);
  into.mass(index) = tails(1);
  rest.array() += tails(1) / data_.omega.array().square() - tails(0);
  into.cost += (rest.cwiseAbs2().array() * weights_.col(index).array()).sum();
  into.residual.push_back(std::move(rest));
}

void Kernel::reduce(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams,
                    Evaluation& into) const {
  const Index modes = poles.size();
  const Index unknowns = parameter_count(data_, modes);
  into.hessian = MatrixXd::Zero(unknowns, unknowns);
  into.gradient = VectorXd::Zero(unknowns);
  for (Index i = 0; i < data_.responses; ++i) {
    MatrixXd normal = MatrixXd::Zero(2 * modes, 2 * modes);
    MatrixXd mixed = MatrixXd::Zero(2 * modes, unknowns);
    VectorXd slope = VectorXd::Zero(2 * modes);
    for (std::size_t f = 0; f < data_.entries.size(); ++f) {
      const FitEntry& entry = data_.entries[f];
      if (entry.response != i) continue;
      const std::vector<Column> linear = linear_columns(poles, entry.excitation);
      const std::vector<Column> free = parameter_columns(poles, entry.excitation, into.right.row(i));
      const VectorXcd product = paired_product(basis, 2 * modes, weights_.col(static_cast<Index>(f)), into.residual[f]);
      add_gram(normal, grams[f], linear, linear);
      add_gram(mixed, grams[f], linear, free);
      add_gram(into.hessian, grams[f], free, free);
      add_product(slope, product, linear);
      add_product(into.gradient, product, free);
    }
    // The slope is zero but for rounding in the linear solution, which it takes out of the gradient.
    const MatrixXd eliminated = ScaledCholesky(normal).solve(mixed);
    into.hessian -= mixed.transpose() * eliminated;
    into.gradient -= eliminated.transpose() * slope;
  }
}

void Kernel::measure(std::vector<Candidate>& candidates, const Poles& poles, const Evaluation& base) const {
  constexpr std::size_t batch = 32;
  VectorXcd lambda(poles.size());
  for (Index k = 0; k < poles.size(); ++k) lambda(k) = poles.pole(k);
  const Atoms present = make_atoms(lambda, false, data_.omega, weights_);
  const std::vector<Column> present_columns = unit_columns(poles.size());
  std::vector<ScaledCholesky> factors;
  std::vector<VectorXd> slopes;
  for (std::size_t f = 0; f < data_.entries.size(); ++f) {
    const auto index = static_cast<Index>(f);
    MatrixXd normal = MatrixXd::Zero(2 * poles.size(), 2 * poles.size());
    VectorXd slope = VectorXd::Zero(2 * poles.size());
    add_gram(normal, PairGram(gram(present, present, index, tail_inverse_[f]), poles.size(), poles.size()),
             present_columns, present_columns);
    add_product(slope, paired_product(present, poles.size(), weights_.col(index), base.residual[f]), present_columns);
    factors.emplace_back(normal);
    slopes.push_back(slope);
  }
  for (std::size_t begin = 0; begin < candidates.size(); begin += batch) {
    const std::size_t count = std::min(batch, candidates.size() - begin);
    const auto tried = static_cast<Index>(count);
    VectorXcd trial(tried);
    for (std::size_t c = 0; c < count; ++c)
      trial(static_cast<Index>(c)) = pole_of(candidates[begin + c].omega, candidates[begin + c].zeta);
    const Atoms added = make_atoms(trial, false, data_.omega, weights_);
    const std::vector<Column> columns = unit_columns(tried);
    for (std::size_t c = 0; c < count; ++c) {
      candidates[begin + c].gain = 0.0;
      candidates[begin + c].residue = MatrixXcd::Zero(data_.responses, data_.excitations);
    }
    for (std::size_t f = 0; f < data_.entries.size(); ++f) {
      const auto index = static_cast<Index>(f);
      MatrixXd mixed = MatrixXd::Zero(2 * poles.size(), 2 * tried);
      VectorXd rhs = VectorXd::Zero(2 * tried);
      add_gram(mixed, PairGram(gram(present, added, index, tail_inverse_[f]), poles.size(), tried), present_columns,
               columns);
      add_product(rhs, paired_product(added, tried, weights_.col(index), base.residual[f]), columns);
      const MatrixXd eliminated = factors[f].solve(mixed);
      rhs -= eliminated.transpose() * slopes[f];
      const PairGram own(gram(added, added, index, tail_inverse_[f]), tried, tried);
      for (std::size_t c = 0; c < count; ++c) {
        const auto at = static_cast<Index>(2 * c);
        Eigen::Matrix2d square;
        for (Index p = 0; p < 2; ++p) {
          for (Index q = 0; q < 2; ++q) {
            square(p, q) = own(columns[static_cast<std::size_t>(at + p)], columns[static_cast<std::size_t>(at + q)]);
          }
        }
        const double before = square.trace();
        square -= mixed.middleCols(at, 2).transpose() * eliminated.middleCols(at, 2);
        if (!(square.determinant() > 1e-16 * before * before)) continue;  // no other than those present
        const Eigen::Vector2d amplitude = square.inverse() * rhs.segment(at, 2);
        candidates[begin + c].gain += amplitude.dot(rhs.segment(at, 2));
        candidates[begin + c].residue(data_.entries[f].response, data_.entries[f].excitation) =
            Complex(amplitude(0), amplitude(1));
      }
    }
  }
}

}  // namespace robomill::modal::detail
