#pragma once
#include <Eigen/Core>

/// Decompositions of dense matrices, compiled once: what Eigen's templates cost to compile is paid here.
namespace robomill::linear_algebra {

/// A⁻¹ of a square matrix, by LU with partial pivoting; not finite where A is singular.
[[nodiscard]] Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);
[[nodiscard]] Eigen::MatrixXcd inverse(const Eigen::MatrixXcd& a);

/// x of A x = b, by LU with partial pivoting; not finite where A is singular.
[[nodiscard]] Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// λ of A v = λ v, of a square matrix; of a real one the vectors too.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXcd& a);
struct EigenPairs {
  Eigen::VectorXcd values = {};   ///< length n
  Eigen::MatrixXcd vectors = {};  ///< n x n, a column a value
  bool converged = false;
};
[[nodiscard]] EigenPairs eigen_pairs(const Eigen::MatrixXd& a);

/// The same of a symmetric matrix, of which the lower triangle is read: values increasing, vectors orthonormal.
struct SymmetricEigenPairs {
  Eigen::VectorXd values = {};
  Eigen::MatrixXd vectors = {};
};
[[nodiscard]] SymmetricEigenPairs symmetric_eigen_pairs(const Eigen::MatrixXd& a);

/// A = U diag(values) Vᴴ with k = min(rows, columns) columns in U and V, values decreasing.
struct ThinSvd {
  Eigen::MatrixXd u = {}, v = {};
  Eigen::VectorXd values = {};
};
[[nodiscard]] ThinSvd thin_svd(const Eigen::MatrixXd& a);
struct ComplexThinSvd {
  Eigen::MatrixXcd u = {}, v = {};
  Eigen::VectorXd values = {};
};
[[nodiscard]] ComplexThinSvd thin_svd(const Eigen::MatrixXcd& a);

}  // namespace robomill::linear_algebra
