#pragma once
#include <vector>

#include "robomill/modal/frf.hpp"

namespace robomill::modal {

/// A resonance as seen in the magnitude of FRFs.
struct Peak {
  double frequency_hz = 0.0;
  double prominence = 0.0;     ///< ln |H| above the higher of the two saddles beside it
  double damping_ratio = 0.0;  ///< half-power width over twice the frequency: of all modes under the peak together
  double receptance = 0.0;     ///< largest magnitude among the FRFs there [m/N]
};

/// Local maxima of ln |H| in any of the FRFs that stand out by 0.23 (2 dB) and by ten times the noise around them; of
/// those within 5 % of each other the most prominent. By rising frequency.
[[nodiscard]] std::vector<Peak> pick_peaks(const Eigen::VectorXd& frequency_hz, const std::vector<const Frf*>& frfs);
/// The same numbers at a frequency that somebody names.
[[nodiscard]] Peak peak_at(double frequency_hz, const Eigen::VectorXd& axis_hz, const std::vector<const Frf*>& frfs);

}  // namespace robomill::modal
