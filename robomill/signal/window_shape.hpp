#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/signal/README.md, "Method"

namespace robomill::signal {

/// A window's shape: coefficients c_j of cosine sums, half width of the main lobe [lines], highest side lobe [dB].
enum class WindowKind {
  hann,             ///< 0.5, 0.5; 2 lines, -31 dB; reaches zero at its ends, side lobes fall fast
  hamming,          ///< 0.54, 0.46; 2 lines, -43 dB; steps of 0.08 at its ends, side lobes fall slowly
  blackman,         ///< 0.42, 0.5, 0.08; 3 lines, -58 dB
  blackman_harris,  ///< 0.35875, 0.48829, 0.14128, 0.01168; 4 lines, -92 dB: weak lines beside strong ones
  nuttall,          ///< 0.355768, 0.487396, 0.144232, 0.012604; 4 lines, -93 dB, with a continuous first derivative
  flat_top,         ///< five terms; 5 lines, -93 dB; a sine between two lines shows only 0.01 dB low
  gaussian,         ///< exp(-(u/σ)²/2), u = d/n; with σ = 1/8 -88 dB
  kaiser            ///< I0(β √(1 - 4u²))/I0(β); with β = 9 3 lines, -66 dB; β trades width against side lobes
};

/// g(t) about its centre, over n samples d = -n/2 … n/2 - 1, n even. With u = d/n:
/// - cosine sums, Σ_j c_j cos(2πju): hann, hamming (0.54, 0.46), blackman (0.42, 0.5, 0.08),
///   blackman_harris (four terms) [Harris1978], nuttall (four terms, continuous first derivative) [Nuttall1981],
///   flat_top (five terms) [DAntonaFerrero2006];
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
