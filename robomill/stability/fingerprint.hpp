#pragma once
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability {

/// A cut that was listened to.
struct ROBOMILL_API MeasuredPeaks {
  std::vector<double> frequency_hz = {};  ///< peaks of the spectrum [Hz], > 0; at least one
  double spindle_speed_rad_per_s = 0.0;   ///< as commanded [rad/s], > 0; required
  int teeth = 0;                          ///< >= 1; required
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API FingerprintOptions {
  double tolerance_hz = 1.0;  ///< how far a peak may lie from what explains it [Hz], > 0, below a quarter of rotation
  double speed_tolerance = 2e-3;  ///< share by which the true speed may differ from the commanded one, in [0, 0.05]
};

/// One way to explain a peak.
struct Explanation {
  /// tooth_passing: n rotations, n a multiple of the teeth. rotation: n rotations. chatter: |f_k + n rotations|.
  enum class Kind { tooth_passing, rotation, chatter, unexplained };
  Kind kind = Kind::unexplained;
  int harmonic = 0;               ///< n
  bool mirrored = false;          ///< f_k + n rotations is negative: the peak is -n rotations less the mode's frequency
  int mode = 0;                   ///< k, from 1; 0 but for chatter
  bool of_tooth_passing = false;  ///< whether n is a multiple of the teeth
  double expected_hz = 0.0;       ///< what n, the speed and the mode give
  double difference_hz = 0.0;     ///< peak less that
  double tolerance_hz = 0.0;      ///< that was allowed: the option's, or the mode's half width ζ f where that is more
};

struct ExplainedPeak {
  double frequency_hz = 0.0;
  Explanation best;                      ///< tooth passing before rotation before chatter; see `explain`
  std::vector<Explanation> others = {};  ///< that are within their tolerance too, best first
};

struct Fingerprint {
  double spindle_speed_rad_per_s = 0.0;  ///< that the peaks which are multiples of rotation agree on, or as commanded
  bool speed_from_peaks = false;
  std::vector<ExplainedPeak> peaks;
  int mode = 0;                       ///< that explains most of the chatter peaks; 0: there are none
  double chatter_frequency_hz = 0.0;  ///< mean of that mode's peaks less their multiples of rotation
};

[[nodiscard]] ROBOMILL_API std::string_view to_string(Explanation::Kind kind);

/// Names each peak. Chatter appears at f = |f_k + n f_rotation|: with equal teeth at multiples of tooth passing from
/// the mode alone, with runout at the others too. Of several modes the one counts whose multiple is one of tooth
/// passing, then the one that is nearest in its tolerance.
///
/// The speed is the commanded one, or another within speed_tolerance at which two peaks at least are multiples of
/// rotation and more peaks are explained; refined by least squares over the multiples of rotation.
/// @throws InvalidInput if an input is out of range
[[nodiscard]] ROBOMILL_API Fingerprint explain(const MeasuredPeaks& peaks, const modal::ModalModel& modes,
                                               const FingerprintOptions& options = {});

/// Whether a cut's chatter needs the wave that the tooth before left.
struct DelayVerdict {
  enum class Kind { stable, regenerative, mode_coupling };
  Kind kind = Kind::stable;
  double spectral_radius = 0.0;       ///< of one period, as evaluate_point has it
  double without_delay = 0.0;         ///< of the same period with F = Σ_j K_j(t) q(t)
  double chatter_frequency_hz = 0.0;  ///< of the cut with the delay
  int mode = 0;                       ///< the same
};
[[nodiscard]] ROBOMILL_API std::string_view to_string(DelayVerdict::Kind kind);

/// Regenerative: unstable, and stable once the delayed displacement is left out of the force. Mode coupling: unstable
/// without it too. The periodic equation without delay is integrated exactly in its modes, by Runge-Kutta's fourth
/// order in its force; every tooth cuts, at the mean speed.
/// @throws InvalidInput if the problem or the point is out of range
[[nodiscard]] ROBOMILL_API DelayVerdict needs_delay(const LobesProblem& problem, const OperatingPoint& point);

}  // namespace robomill::stability
