#pragma once
#include <Eigen/Core>

namespace robomill::modal::detail {

/// exp(S) of a small symmetric matrix: positive definite whatever S is.
class SymmetricExponential {
 public:
  /// @param logarithm  S, n x n
  explicit SymmetricExponential(const Eigen::MatrixXd& logarithm);
  [[nodiscard]] const Eigen::MatrixXd& value() const { return value_; }
  /// ∂ exp(S) / ∂S_ij, with S_ji the same number: Q (Φ ∘ Qᵀ (∂S) Q) Qᵀ, Φ_ab = (eᵃ − eᵇ)/(a − b) of the eigenvalues.
  [[nodiscard]] Eigen::MatrixXd derivative(Eigen::Index row, Eigen::Index column) const;

 private:
  Eigen::MatrixXd value_, vectors_, quotients_;
};

}  // namespace robomill::modal::detail
