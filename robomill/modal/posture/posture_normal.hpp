#pragma once
#include <Eigen/Core>

#include "robomill/modal/posture/flexible_arm.hpp"
#include "robomill/modal/posture/smoothed_frf.hpp"

namespace robomill::modal::detail {

/// One posture's share of the cost, its gradient and Gauss-Newton matrix.
struct PostureNormal {
  double cost = 0.0;       ///< Σ |r|² loss'd
  double error = 0.0;      ///< Σ |ΔH|, and …
  double size = 0.0;       ///< … Σ |H|
  double residuals = 0.0;  ///< how many
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

/// At these parameters, Σ c² ln(1 + |Δ|² weight² / c²) over lines and entries: large residuals count less. Δ is
/// |H| ln(H_model / H) on the diagonal, H_model − H beside it.
/// @param derivatives  else matrix and gradient stay zero
[[nodiscard]] PostureNormal normal_of(const FlexibleArm& arm, const Eigen::VectorXd& joints, const SmoothedFrf& frf,
                                      const Eigen::VectorXd& parameters, bool derivatives);

}  // namespace robomill::modal::detail
