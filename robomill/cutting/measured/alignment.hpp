#pragma once
#include <Eigen/Core>
#include <complex>
#include <utility>
#include <vector>

#include "robomill/cutting/measured_force.hpp"

namespace robomill::cutting::detail {

/// Correlations between a measured and a predicted revolution at the same even steps, turned against each other.
class Correlation {
 public:
  Correlation(const Eigen::Matrix3Xd& measured, const Eigen::Matrix3Xd& predicted);

  /// Mean over the revolution of measured component a times predicted component b, which is `offset` ahead: m_a(φ)
  /// p_b(φ + δ).
  [[nodiscard]] double of(int a, int b, double offset_rad) const;
  /// The offset in [0, period) of the greatest sum over the components, each with itself, and that sum.
  [[nodiscard]] std::pair<double, double> best_offset(double period_rad) const { return best(period_rad, {1, 2, 3}); }
  /// The same where the prediction's axis i is the record's axes[i].
  [[nodiscard]] std::pair<double, double> best(double period_rad, const SignedAxes& axes) const;

 private:
  [[nodiscard]] double sum(const SignedAxes& axes, double offset_rad) const;
  std::vector<Eigen::Matrix3cd> products_;  ///< of each harmonic from 0: conj(M_k) P_k^T, twice for k > 0
};

/// Fourier coefficient k of each component over the revolution: Σ x e^(-ikφ) / steps.
[[nodiscard]] Eigen::Vector3cd harmonic(const Eigen::Matrix3Xd& force, Eigen::Index k);

/// All 48 ways in which a record's axes may be signed and ordered.
[[nodiscard]] std::vector<SignedAxes> all_signed_axes();

}  // namespace robomill::cutting::detail
