#pragma once
#include <Eigen/Core>
#include <vector>

namespace robomill::signal {

/// A window's shape: coefficients c_j of cosine sums, half width of the main lobe [lines], highest side lobe [dB].
enum class WindowKind {
  hann,            ///< 0.5, 0.5; 2 lines, -31 dB; reaches zero at its ends, side lobes fall fast
  blackman_harris  ///< 0.35875, 0.48829, 0.14128, 0.01168; 4 lines, -92 dB: weak lines beside strong ones [Harris1978]
};

/// c_j of g(d) = Σ_j c_j cos(2πjd/n) about its centre, over n samples d = -n/2 … n/2 - 1, n even; g(0) = Σ c_j = 1.
[[nodiscard]] std::vector<double> window_cosines(WindowKind kind);

/// g(d), d = -n/2 … n/2 - 1.
/// @throws InvalidInput if n is odd or below 2
[[nodiscard]] Eigen::VectorXd window_samples(WindowKind kind, Eigen::Index n);

/// dg/dt [1/s] at the same places, in closed form.
/// @throws InvalidInput if n is odd or below 2, or the rate is not > 0
[[nodiscard]] Eigen::VectorXd window_derivative(WindowKind kind, Eigen::Index n, double sample_rate_hz);

}  // namespace robomill::signal
