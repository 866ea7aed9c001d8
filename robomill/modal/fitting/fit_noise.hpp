#pragma once
// How large the error of each line is.
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/fit.hpp"
#include "robomill/modal/fitting/fit_kernel.hpp"

namespace robomill::modal::detail {

/// Variance of each line's error as coherence or deviation give it, smoothed over neighbouring lines, since both are
/// themselves estimates from a few hits. Of coherence only the shape means something: (1 - γ²) / γ² |H|².
[[nodiscard]] Eigen::VectorXd known_variance(const Frf& frf, Weighting weighting);

/// Variance from the scatter between neighbouring lines: |value - line through its neighbours|², scaled to the variance
/// of white noise; length n.
[[nodiscard]] Eigen::VectorXd scatter(const Eigen::VectorXd& omega, const Eigen::VectorXcd& values);
/// Standard deviation of noise as a share of |H|, on the median line.
[[nodiscard]] double relative_scatter(const Eigen::VectorXd& omega, const Eigen::VectorXcd& residual,
                                      const Eigen::VectorXcd& receptance);

/// a² + b² |H|² by the likelihood of `squares`, complex Gaussian errors' absolute squares.
[[nodiscard]] Eigen::VectorXd variance_of_size(const Eigen::VectorXd& squares, const Eigen::VectorXd& size2);

/// As variance_of_size, but from the FRF alone: medians, since at sharp peaks the scatter is no noise.
[[nodiscard]] Eigen::VectorXd first_variance(const Eigen::VectorXd& omega, const Eigen::VectorXcd& receptance);

/// The constant m² that makes `variance` + m² the likeliest variance of `squares`: what the model cannot follow.
[[nodiscard]] double misfit_variance(const Eigen::VectorXd& squares, const Eigen::VectorXd& variance);

/// Lines that carry as much information as one independent line: 1 + 2 Σ autocorrelation of the weighted residuals,
/// >= 1.
[[nodiscard]] double correlation_length(const FitData& data, const Eigen::MatrixXcd& residual);

}  // namespace robomill::modal::detail
