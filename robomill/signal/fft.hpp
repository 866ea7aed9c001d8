#pragma once
#include <Eigen/Core>

namespace robomill::signal {

/// The lines k = 0 … n/2 (rounded down) of X_k = Σ_j x_j exp(-2πi jk/n), of any length n >= 1 (prime factors above 50
/// by Bluestein's method). [Bluestein1970]
/// @param x  length n
/// @throws InvalidInput if x is empty
[[nodiscard]] Eigen::VectorXcd real_fft(const Eigen::Ref<const Eigen::VectorXd>& x);
/// The real signal of length n whose real_fft is `half` (length n/2 + 1, rounded down); imaginary parts that no real
/// signal can have (at zero and, for even n, at the last line) are dropped.
/// @throws InvalidInput if the lengths do not fit
[[nodiscard]] Eigen::VectorXd inverse_real_fft(const Eigen::Ref<const Eigen::VectorXcd>& half, Eigen::Index n);

}  // namespace robomill::signal
