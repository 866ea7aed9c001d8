#include "robomill/modal/posture/symmetric_exponential.hpp"

#include <cmath>

#include "robomill/base/linear_algebra.hpp"

namespace robomill::modal::detail {

SymmetricExponential::SymmetricExponential(const Eigen::MatrixXd& logarithm) {
  const Eigen::Index n = logarithm.rows();
  if (n == 1) {
    value_ = quotients_ = Eigen::MatrixXd::Constant(1, 1, std::exp(logarithm(0, 0)));
    vectors_ = Eigen::MatrixXd::Identity(1, 1);
    return;
  }
  const linear_algebra::SymmetricEigenPairs pairs = linear_algebra::symmetric_eigen_pairs(logarithm);
  vectors_ = pairs.vectors;
  value_ = vectors_ * pairs.values.array().exp().matrix().asDiagonal() * vectors_.transpose();
  quotients_.resize(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      // (eᵃ − eᵇ)/(a − b) = e^((a + b)/2) sinh(d)/d, d = (a − b)/2
      const double half = 0.5 * (pairs.values(a) - pairs.values(b));
      const double middle = std::exp(0.5 * (pairs.values(a) + pairs.values(b)));
      constexpr double small = 1e-4;
      quotients_(a, b) = middle * (std::abs(half) < small ? 1.0 + half * half / 6.0 : std::sinh(half) / half);
    }
  }
}

Eigen::MatrixXd SymmetricExponential::derivative(Eigen::Index row, Eigen::Index column) const {
  // Qᵀ ∂S Q of the one entry, or the two that mirror each other.
  Eigen::MatrixXd turned = vectors_.row(row).transpose() * vectors_.row(column);
  if (row != column) turned += vectors_.row(column).transpose() * vectors_.row(row);
  return vectors_ * quotients_.cwiseProduct(turned) * vectors_.transpose();
}

}  // namespace robomill::modal::detail
