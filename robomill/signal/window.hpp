#pragma once
#include <Eigen/Core>

namespace robomill::signal {

/// Periodic Hann window, w_j = (1 - cos(2πj/n)) / 2, j = 0 … n-1. [Harris1978]
/// @throws InvalidInput if n < 1
[[nodiscard]] Eigen::VectorXd hann_window(Eigen::Index n);

/// w_j = exp(-j / (sample_rate_hz τ)). On force and response alike it moves every pole by -1/τ: H(s) is seen as H(s +
/// 1/τ). [Fladung1997]
/// @param n                number of samples, >= 1
/// @param time_constant_s  τ > 0
/// @throws InvalidInput if an argument is out of its range
[[nodiscard]] Eigen::VectorXd exponential_window(Eigen::Index n, double sample_rate_hz, double time_constant_s);

/// One on the samples first … last, falling to zero as half a cosine over `taper` samples on both sides, zero
/// elsewhere.
/// @param n  number of samples; 0 <= first <= last < n, taper >= 0
/// @throws InvalidInput if an argument is out of its range
[[nodiscard]] Eigen::VectorXd force_window(Eigen::Index n, Eigen::Index first, Eigen::Index last, Eigen::Index taper);

}  // namespace robomill::signal
