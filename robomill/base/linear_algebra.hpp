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
[[nodiscard]] Eigen::MatrixXcd solve(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

/// x of A x = b with A symmetric and positive definite, by Cholesky's LLᵀ of its lower triangle; not checked.
[[nodiscard]] Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::MatrixXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// x of A x = b with A Hermitian and semidefinite, by LDLᴴ of its lower triangle.
[[nodiscard]] Eigen::MatrixXcd solve_hermitian(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b);

/// A = L Lᵀ of a symmetric matrix, of which the lower triangle is read.
struct Cholesky {
  Eigen::MatrixXd lower = {};      ///< n x n, lower triangular; without meaning where A is not positive definite
  bool positive_definite = false;  ///< up to rounding
};
[[nodiscard]] Cholesky cholesky(const Eigen::MatrixXd& a);

/// λ of A v = λ v, of a square matrix; with the vectors.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXcd& a);
struct EigenPairs {
  Eigen::VectorXcd values = {};   ///< length n
  Eigen::MatrixXcd vectors = {};  ///< n x n, a column a value
  bool converged = false;
};
[[nodiscard]] EigenPairs eigen_pairs(const Eigen::MatrixXd& a);
[[nodiscard]] EigenPairs eigen_pairs(const Eigen::MatrixXcd& a);

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

/// x of least |A x − b|, A m x n of full rank, m >= n, by Householder's QR.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The same by QR with pivoting of columns, of any rank.
[[nodiscard]] Eigen::VectorXd least_squares_with_pivots(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
[[nodiscard]] Eigen::MatrixXd least_squares_with_pivots(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
[[nodiscard]] Eigen::VectorXcd least_squares_with_pivots(const Eigen::MatrixXcd& a, const Eigen::VectorXcd& b);

/// R of A = Q R, A m x n with m >= n: n x n, upper triangular.
[[nodiscard]] Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& a);

}  // namespace robomill::linear_algebra
