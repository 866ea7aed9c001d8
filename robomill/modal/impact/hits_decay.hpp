#pragma once
#include <Eigen/Core>

namespace robomill::modal {

/// What the last quarter of a response says.
struct Tail {
  Eigen::VectorXd
      noise_density;  ///< E|x_j|² of each line's noise as if white: |FFT|² / Σ w²; lines of the quarter's transform
  double spacing_hz = 0.0;  ///< of those lines
  double remaining =
      0.0;  ///< highest ratio, end to begin, of the amplitude of anything that still rings; 0 if nothing does
  double remaining_hz = 0.0;  ///< where that is
};

/// Compares the spectra of the first and the last quarter. What rings on at the end stands as a narrow line above the
/// median of its neighbourhood, by more than noise would once in 1e12 lines; what is as strong at the end as at the
/// start is hum.
/// @param response      from the hit on, at least 64 samples, without its offset
/// @param max_frequency_hz  nothing is looked for above
[[nodiscard]] Tail look_at_tail(const Eigen::VectorXd& response, double sample_rate_hz, double max_frequency_hz);

}  // namespace robomill::modal
