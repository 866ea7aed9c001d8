#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "robomill/modal/hits.hpp"

namespace robomill::modal {

/// What the averaging knows about one FRF beyond the FRF itself; vectors have one entry a line.
struct FrfEvidence {
  int hits = 0;
  Eigen::VectorXd force_n_s;  ///< root mean square of the hits' force spectra
  Eigen::VectorXd
      relative_noise;  ///< standard deviation of the averaged FRF / |H|: from the spread of hits, else from the tail
  Eigen::VectorXd sensor_noise;  ///< the same from what the response's sensor shows after the response has decayed
  Eigen::VectorXd drift;         ///< what the drift of that sensor's zero comes to / |H|
  double remaining = 0.0;        ///< amplitude left at the record's end, of the loudest that still rings
  double remaining_hz = 0.0;
  bool restless = false;  ///< the structure moved before it was hit
};

/// What the drift of the sensor's zero comes to on each line, in the unit of `ratio`.
///
/// A structure that is held neither accelerates nor moves on at zero frequency, so what the lines 2 to 9 show is drift
/// (or noise, or at most the structure itself). It is taken on from there as flicker noise, falling with the root of
/// frequency. A body that hangs free does accelerate: there all these lines are one real number, 1/mass, and the answer
/// is zero.
/// @param ratio         acceleration or velocity per force, lines 0 … n-1, n > 9
/// @param integrations  2 for acceleration, 1 for velocity
[[nodiscard]] Eigen::VectorXd drift_of(const Eigen::VectorXcd& ratio, double spacing_rad_per_s, int integrations);

/// The band in which the force spectrum lies within 20 dB of its highest line, walking both ways from there.
struct Band {
  double low_hz = 0.0;
  double high_hz = 0.0;
};
[[nodiscard]] Band excited_band(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& force_n_s);

/// Lowest line from which on noise and drift stay below a tenth of |H| on four fifths of the lines of the next third of
/// an octave, and of the next octave; the highest line where there is none.
[[nodiscard]] double lowest_trustworthy(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXd& relative_error);

/// @param evidence  one for each FRF of the set, in its order
[[nodiscard]] std::vector<FrfGrade> grade_frfs(const FrfSet& set, const std::vector<FrfEvidence>& evidence,
                                               const HitOptions& options);

}  // namespace robomill::modal
