#pragma once
#include <Eigen/Core>

namespace robomill::modal {

/// The hammer's pulse in a record of its force; positions and lengths in samples.
struct Pulse {
  double offset_n = 0.0;   ///< what the sensor reads without a force
  double noise_n = 0.0;    ///< standard deviation away from the pulse, robust
  double peak_n = 0.0;     ///< above the offset; < 0 where the highest excursion is a pull
  double width = 0.0;      ///< full width at half the peak
  Eigen::Index peak = 0;   ///< where it is highest
  Eigen::Index first = 0;  ///< first and last sample above 1 % of the peak and the noise
  Eigen::Index last = 0;
  double second_ratio = 0.0;  ///< highest further pulse / peak_n; 0 where none stands out of noise and ringing
};

/// @param force_n  finite, not all zero
[[nodiscard]] Pulse find_pulse(const Eigen::VectorXd& force_n);

/// Whether the record was clipped: it stays at its highest or lowest value, and comes there or leaves there with a jump
/// in slope.
[[nodiscard]] bool has_flat_top(const Eigen::VectorXd& samples);

}  // namespace robomill::modal
