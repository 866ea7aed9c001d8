#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::signal {

enum class WindowKind { hann, hamming, blackman, blackman_harris, nuttall, flat_top, gaussian, kaiser };

/// g(t) about its centre, over n samples d = -n/2 … n/2 - 1, n even. With u = d/n:
/// - cosine sums, Σ_j c_j cos(2πju): hann, hamming (0.54, 0.46), blackman (0.42, 0.5, 0.08), blackman_harris (four
/// terms,
///   -92 dB) [Harris1978], nuttall (four terms, continuous first derivative, -93 dB) [Nuttall1981], flat_top (five
///   terms) [DAntonaFerrero2006];
/// - gaussian: exp(-(u/σ)²/2), parameter σ, default 1/8;
/// - kaiser: I0(β √(1 - 4u²))/I0(β), parameter β, default 9 [Harris1978].
struct ROBOMILL_API WindowShape {
  WindowKind kind = WindowKind::hann;
  double parameter = 0.0;  ///< σ or β, > 0; 0: the default. Cosine sums have none
  /// @throws InvalidInput naming the field
  void validate() const;
  /// c_j of a cosine sum; empty for the others. g(0) = 1 for every shape but flat_top, where it is Σ c_j.
  [[nodiscard]] std::vector<double> cosines() const;
};

/// g(d), d = -n/2 … n/2 - 1.
/// @throws InvalidInput if n is odd or below 2
[[nodiscard]] ROBOMILL_API Eigen::VectorXd window_samples(const WindowShape& shape, Eigen::Index n);

/// dg/dt [1/s] at the same places, in closed form. The steps of windows that do not reach zero at their ends (hamming,
/// gaussian, kaiser) are not part of it.
/// @throws InvalidInput if n is odd or below 2, or the rate is not > 0
[[nodiscard]] ROBOMILL_API Eigen::VectorXd window_derivative(const WindowShape& shape, Eigen::Index n,
                                                             double sample_rate_hz);

}  // namespace robomill::signal
