#pragma once
// The basis functions of poles over the lines and their inner products.
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/modal/fitting/fit_data.hpp"

namespace robomill::modal::detail {

/// What stays the same over all poles: lines and weights.
struct Lines {
  explicit Lines(const FitData& data);

  Eigen::VectorXd omega;
  Eigen::Index entries = 0;
  Eigen::MatrixXd columns;  // n x 4 entries: weight², weight² / s², Re and Im weight² (data without tails)
  std::vector<Eigen::Matrix2d>
      tail_inverse;  // inverse Gram matrix of the tails 1 and 1/s²; zero where data has no residuals

  /// (1, 1/s²)ᴴ weight² values.
  [[nodiscard]] Eigen::Vector2cd tail_product(Eigen::Index entry, const Eigen::VectorXcd& values) const;
};

/// φ = 1/(s - μ) and, if wanted, φ' = 1/(s - μ)², for μ the poles λ and then their conjugates.
struct Atoms {
  using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Atoms(const Eigen::VectorXcd& lambda, bool with_derivatives, const Lines& lines);

  Eigen::VectorXcd mu;         // length 2m
  Table re, im;                // n x atoms: φ, then φ'
  Eigen::MatrixXcd sum, tail;  // atoms x entries: Σ weight² φ and Σ weight² φ / s²
  Eigen::MatrixXcd data;       // m x entries: `paired` with the data
  [[nodiscard]] Eigen::Index modes() const { return mu.size() / 2; }
  [[nodiscard]] bool derivatives() const { return re.cols() > mu.size(); }
  /// φᴴ weight² values + conj(φ̃ᴴ weight² values), φ̃ that of the conjugate pole, for the first `functions` (m: φ, 2m: φ'
  /// too).
  /// @param values  n x entries  @return functions x entries
  [[nodiscard]] Eigen::MatrixXcd paired(Eigen::Index functions, const Eigen::MatrixXcd& values,
                                        const Lines& lines) const;
  /// Where the function of a pole stands among the atoms; its conjugate's stands m after it.
  [[nodiscard]] Eigen::Index own(Eigen::Index function) const {
    return function < modes() ? function : modes() + function;
  }
};

/// A real column α φ_a + conj(α) φ̃_a of the model's Jacobian.
struct Column {
  Eigen::Index function;
  std::complex<double> alpha;
  Eigen::Index unknown;
};

/// Inner products of such columns over the lines of one entry, tails projected out:
/// Re(conj(α) (β same(a, b) + conj(β) mixed(a, b))).
///
/// On the imaginary axis conj(1/(s - a)) · 1/(s - b) = -(1/(s - b) - 1/(s + conj a)) / (b + conj a), so that all of
/// them follow from one sum over the lines for each pole; those of the derivatives are the derivatives of that.
struct PairGram {
  PairGram(const Atoms& a, const Atoms& b, Eigen::Index entry, const Lines& lines);

  Eigen::MatrixXcd same, mixed;
  [[nodiscard]] double operator()(const Column& a, const Column& b) const {
    const std::complex<double> product =
        b.alpha * same(a.function, b.function) + std::conj(b.alpha) * mixed(a.function, b.function);
    return a.alpha.real() * product.real() + a.alpha.imag() * product.imag();
  }
  void add(Eigen::MatrixXd& into, const std::vector<Column>& rows, const std::vector<Column>& columns) const;
};

/// Adds the columns' products with values, of which `paired` holds one entry's column.
void add_product(Eigen::VectorXd& into, const Eigen::MatrixXcd& paired, Eigen::Index entry,
                 const std::vector<Column>& columns);

/// Solves symmetric positive systems whose unknowns have very different sizes; a dependent unknown gets about zero.
class ScaledCholesky {
 public:
  explicit ScaledCholesky(const Eigen::MatrixXd& gram);
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const;

 private:
  Eigen::VectorXd scale_;
  Eigen::MatrixXd factor_;  // lower Cholesky factor
};

}  // namespace robomill::modal::detail
