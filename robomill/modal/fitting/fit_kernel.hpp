#pragma once
// Variable projection: everything but poles and left vectors is linear and eliminated.
#include <Eigen/Core>
#include <complex>
#include <vector>

#include <span>
#include "robomill/modal/fitting/fit_atoms.hpp"
#include "robomill/modal/fitting/fit_data.hpp"

namespace robomill::modal::detail {

/// The best linear parameters at given poles, and the reduced problem there.
struct Evaluation {
  double cost = 0.0;                 // Σ weight² |residual|²
  Eigen::MatrixXcd right;            // responses x m
  Eigen::VectorXcd mass, stiffness;  // an entry each; mass multiplies 1 / s²
  Eigen::MatrixXcd residual;         // n x entries: data - model, not weighted
  Eigen::MatrixXd hessian;           // parameters x parameters: JᵀJ with the linear parameters eliminated
  Eigen::VectorXd gradient;          // Jᵀ residual, likewise (the direction of descent)
  Eigen::VectorXd loss;              // what the cost would rise by without each mode, poles and left vectors kept
};

/// One more mode, tried on top of an evaluation.
struct Candidate {
  double omega = 0.0, zeta = 0.0;
  double gain = 0.0;              // what it would take off the cost if its residue matrix could be any
  Eigen::MatrixXcd residue = {};  // that matrix, responses x excitations; zero where no entry is
};

/// Variable projection [GolubPereyra2003], its JᵀJ without the term in the residual [Kaufman1975]. O(lines x modes),
/// since inner products of the basis functions need one sum a pole (PairGram).
class Kernel {
 public:
  /// @param data  must outlive the kernel
  explicit Kernel(const FitData& data);
  /// @param derivatives  whether hessian, gradient and loss are wanted
  [[nodiscard]] Evaluation evaluate(const Poles& poles, bool derivatives) const;
  /// Fills in gain and residue of candidates from their ω and ζ. @param base  the evaluation at `poles`
  void measure(std::vector<Candidate>& candidates, const Poles& poles, const Evaluation& base) const;
  [[nodiscard]] const FitData& data() const { return data_; }

 private:
  struct Present;
  void measure_batch(std::span<Candidate> batch, const Present& present, const Evaluation& base) const;
  void solve_linear(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams, Evaluation& into) const;
  void subtract_model(const Poles& poles, const Atoms& basis, Evaluation& into) const;
  void reduce(const Poles& poles, const Atoms& basis, const std::vector<PairGram>& grams, Evaluation& into) const;

  const FitData& data_;
  Lines lines_;
};

}  // namespace robomill::modal::detail
