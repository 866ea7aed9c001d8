#include "robomill/base/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <complex>

#include "robomill/base/random.hpp"

namespace robomill::linear_algebra {
namespace linear_algebra_test {

Eigen::MatrixXd random_matrix(Random& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd out(rows, columns);
  for (double& value : out.reshaped()) value = random.normal();
  return out;
}

// The answers put back into their equations.
TEST(LinearAlgebra, AnswersSolveTheirEquations) {
  Random random(1);
  for (Eigen::Index n = 1; n <= 12; ++n) {
    const Eigen::MatrixXd a = random_matrix(random, n, n), b = random_matrix(random, n, 3);
    const Eigen::MatrixXcd c =
        a.cast<std::complex<double>>() + std::complex<double>(0.0, 1.0) * random_matrix(random, n, n);
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
    EXPECT_LT((a * inverse(a) - one).norm(), 1e-9);
    EXPECT_LT((c * inverse(c) - one).norm(), 1e-9);
    EXPECT_LT((a * solve(a, b) - b).norm(), 1e-9);
    EXPECT_LT((a * solve(a, Eigen::VectorXd(b.col(0))) - b.col(0)).norm(), 1e-9);
    const EigenPairs pairs = eigen_pairs(a);
    ASSERT_TRUE(pairs.converged);
    EXPECT_LT((a * pairs.vectors - pairs.vectors * pairs.values.asDiagonal()).norm(), 1e-9);
    EXPECT_NEAR(std::abs(eigenvalues(a).sum() - a.trace()), 0.0, 1e-9);
    EXPECT_NEAR(std::abs(eigenvalues(c).sum() - c.trace()), 0.0, 1e-9);
    const Eigen::MatrixXd symmetric = a + a.transpose();
    const SymmetricEigenPairs own = symmetric_eigen_pairs(symmetric);
    EXPECT_LT((own.vectors * own.values.asDiagonal() * own.vectors.transpose() - symmetric).norm(), 1e-9);
    const ThinSvd svd = thin_svd(Eigen::MatrixXd(b.transpose()));
    EXPECT_LT((svd.u * svd.values.asDiagonal() * svd.v.transpose() - b.transpose()).norm(), 1e-9);
    const ComplexThinSvd wide = thin_svd(c);
    EXPECT_LT((wide.u * wide.values.asDiagonal() * wide.v.adjoint() - c).norm(), 1e-9);
    const EigenPairs complex_pairs = eigen_pairs(c);
    ASSERT_TRUE(complex_pairs.converged);
    EXPECT_LT((c * complex_pairs.vectors - complex_pairs.vectors * complex_pairs.values.asDiagonal()).norm(), 1e-9);
    EXPECT_LT((c * solve(c, Eigen::MatrixXcd(b)) - b).norm(), 1e-9);
    const Eigen::MatrixXd positive = a * a.transpose() + one;
    const Eigen::MatrixXcd hermitian = c * c.adjoint() + one;
    EXPECT_LT((positive * solve_positive_definite(positive, b) - b).norm(), 1e-9);
    EXPECT_LT((positive * solve_positive_definite(positive, Eigen::VectorXd(b.col(0))) - b.col(0)).norm(), 1e-9);
    EXPECT_LT((hermitian * solve_hermitian(hermitian, Eigen::MatrixXcd(b)) - b).norm(), 1e-9);
    const Cholesky factor = cholesky(positive);
    EXPECT_TRUE(factor.positive_definite);
    EXPECT_LT((factor.lower * factor.lower.transpose() - positive).norm(), 1e-9);
    EXPECT_FALSE(cholesky(-positive).positive_definite);
  }
}

// The residual of least squares is normal to the columns; RᵀR = AᵀA.
TEST(LinearAlgebra, LeastSquaresLeaveWhatIsNormalToTheColumns) {
  Random random(2);
  for (Eigen::Index n = 1; n <= 6; ++n) {
    const Eigen::MatrixXd a = random_matrix(random, 2 * n + 1, n), b = random_matrix(random, 2 * n + 1, 2);
    const Eigen::VectorXd one = b.col(0);
    EXPECT_LT((a.transpose() * (a * least_squares(a, one) - one)).norm(), 1e-9);
    EXPECT_LT((a.transpose() * (a * least_squares_with_pivots(a, one) - one)).norm(), 1e-9);
    EXPECT_LT((a.transpose() * (a * least_squares_with_pivots(a, b) - b)).norm(), 1e-9);
    const Eigen::MatrixXcd c = a.cast<std::complex<double>>() * std::complex<double>(0.6, 0.8);
    const Eigen::VectorXcd x = least_squares_with_pivots(c, Eigen::VectorXcd(one));
    EXPECT_LT((c.adjoint() * (c * x - one)).norm(), 1e-9);
    const Eigen::MatrixXd r = qr_triangle(a);
    EXPECT_TRUE(r.isUpperTriangular(0.0));
    EXPECT_LT((r.transpose() * r - a.transpose() * a).norm(), 1e-9);
  }
}

}  // namespace linear_algebra_test
}  // namespace robomill::linear_algebra
