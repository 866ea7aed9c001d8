#include "robomill/modal/posture/symmetric_exponential.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace robomill::modal::detail {
namespace symmetric_exponential_test {

Eigen::Matrix3d logarithm() {
  Eigen::Matrix3d out;
  out << 1.0, 0.3, -0.2, 0.3, 0.4, 0.7, -0.2, 0.7, -0.5;
  return out;
}

// exp(Q diag(a) Qᵀ) = Q diag(eᵃ) Qᵀ
TEST(SymmetricExponential, TurnsWithItsAxes) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).matrix();
  const Eigen::Vector3d exponents(2.0, -1.0, 0.5);
  const Eigen::Matrix3d expected = turn * exponents.array().exp().matrix().asDiagonal() * turn.transpose();
  const SymmetricExponential found(turn * exponents.asDiagonal() * turn.transpose());
  EXPECT_LT((found.value() - expected).norm(), 1e-12 * expected.norm());
}

// exp(S) exp(-S) = 1
TEST(SymmetricExponential, HasTheInverseOfItsNegative) {
  const Eigen::MatrixXd product =
      SymmetricExponential(logarithm()).value() * SymmetricExponential(-logarithm()).value();
  EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-13);
}

TEST(SymmetricExponential, DifferentiatesByEveryEntry) {
  // Eigenvalues that are all different, that coincide, and a single number.
  for (const Eigen::MatrixXd& at : {Eigen::MatrixXd(logarithm()), Eigen::MatrixXd(2.0 * Eigen::Matrix2d::Identity()),
                                    Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, 0.7))}) {
    const SymmetricExponential here(at);
    constexpr double step = 1e-6;
    for (Eigen::Index i = 0; i < at.rows(); ++i) {
      for (Eigen::Index j = i; j < at.rows(); ++j) {
        Eigen::MatrixXd change = Eigen::MatrixXd::Zero(at.rows(), at.rows());
        change(i, j) = change(j, i) = step;
        const Eigen::MatrixXd difference =
            (SymmetricExponential(at + change).value() - SymmetricExponential(at - change).value()) / (2.0 * step);
        EXPECT_LT((difference - here.derivative(i, j)).norm(), 1e-8 * here.value().norm()) << i << ", " << j;
      }
    }
  }
}

}  // namespace symmetric_exponential_test
}  // namespace robomill::modal::detail
