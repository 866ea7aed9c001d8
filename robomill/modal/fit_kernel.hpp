#pragma once
// The inside of the modal fit: data in fit units, and what variable projection needs at one set of poles.
#include <Eigen/Core>
#include <complex>
#include <vector>

namespace robomill::modal::detail {

/// One FRF of the fit.
struct FitEntry {
  Eigen::Index response = 0, excitation = 0;  // rows of `right`, rows of `left`
  Eigen::VectorXcd receptance;                // length n
  Eigen::VectorXd weight;                     // length n: 1 / standard deviation
};

/// FRFs in units of their size, over ω in units of the band's upper edge: s = iω.
struct FitData {
  Eigen::VectorXd omega;  // length n, > 0, at most 1
  Eigen::Index responses = 0, excitations = 0;
  std::vector<FitEntry> entries;
  bool residuals = true;  // mass and stiffness terms for each entry
};

/// The parameters of the fit that are not linear. Of each mode's left vector the entry `gauge` is 1.
struct Poles {
  Eigen::VectorXd omega, zeta;  // length m
  Eigen::MatrixXcd left;        // excitations x m
  std::vector<Eigen::Index> gauge;

  [[nodiscard]] Eigen::Index size() const { return omega.size(); }
  [[nodiscard]] std::complex<double> pole(Eigen::Index k) const;
  /// Divides each left vector by its largest entry, which becomes its gauge.
  void fix_gauge();
  /// All but the modes of that index.
  [[nodiscard]] Poles without(Eigen::Index k) const;
  /// With one mode more at the end.
  [[nodiscard]] Poles with(double new_omega, double new_zeta, const Eigen::VectorXcd& new_left) const;
};

/// Free real parameters: for each mode ω, ζ, and the real and imaginary part of every entry of left but its gauge.
[[nodiscard]] Eigen::Index parameter_count(const FitData& data, Eigen::Index modes);
[[nodiscard]] Eigen::VectorXd to_parameters(const Poles& poles);
/// @param shape  gives the sizes and the gauges
[[nodiscard]] Poles from_parameters(const Eigen::VectorXd& parameters, const Poles& shape);

/// The best linear parameters at given poles, and the reduced problem there.
struct Evaluation {
  double cost = 0.0;                       // Σ weight² |residual|²
  Eigen::MatrixXcd right;                  // responses x m
  Eigen::VectorXcd mass, stiffness;        // an entry each; mass multiplies 1 / s²
  std::vector<Eigen::VectorXcd> residual;  // an entry each: data - model, not weighted
  Eigen::MatrixXd hessian;                 // parameters x parameters: JᵀJ with the linear parameters eliminated
  Eigen::VectorXd gradient;                // Jᵀ residual, likewise (the direction of descent)
};

/// One more mode, tried on top of an evaluation.
struct Candidate {
  double omega = 0.0, zeta = 0.0;
  double gain = 0.0;              // what it would take off the cost if its residue matrix could be any
  Eigen::MatrixXcd residue = {};  // that matrix, responses x excitations; zero where no entry is
};

struct Atoms;
struct PairGram;

/// Variable projection in O(lines x modes): the inner products of the basis functions 1/(s - λ) over the lines need
/// only sums of one pole, since conj(1/(s - a)) · 1/(s - b) = -(1/(s - b) - 1/(s + conj a)) / (b + conj a) on the
/// imaginary axis.
class Kernel {
 public:
  /// @param data  must outlive the kernel
  explicit Kernel(const FitData& data);
  [[nodiscard]] Evaluation evaluate(const Poles& poles, bool derivatives) const;
  /// Fills in gain and residue of candidates from their ω and ζ. @param base  the evaluation at `poles`
  void measure(std::vector<Candidate>& candidates, const Poles& poles, const Evaluation& base) const;
  [[nodiscard]] const FitData& data() const { return data_; }

 private:
  void solve_linear(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams, Evaluation& into) const;
  void subtract_model(const Poles& poles, const Atoms& basis, std::size_t f, Evaluation& into) const;
  void reduce(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams, Evaluation& into) const;
  [[nodiscard]] Eigen::Vector2cd tail_product(Eigen::Index entry, const Eigen::VectorXcd& values) const;

  const FitData& data_;
  Eigen::MatrixXd weights_;  // n x 2 entries: weight², then weight² / s²
  std::vector<Eigen::Matrix2d>
      tail_inverse_;  // inverse Gram matrix of 1 and 1/s², an entry each; zero without residuals
};

}  // namespace robomill::modal::detail
