#pragma once
#include <limits>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "What the peaks of a cut are (`peak_classification.hpp`, `robomill explain`)"

namespace robomill::stability {

/// The peaks of a recorded cut.
struct ROBOMILL_API MeasuredPeaks {
  static constexpr double highest_hz = 1e6;
  std::vector<double> frequency_hz = {};  ///< peaks of the spectrum [Hz], in (0, highest_hz]; at least one
  double spindle_speed_rad_per_s = 0.0;   ///< as commanded [rad/s], > 0; required
  int teeth = 0;                          ///< >= 1; required
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API PeakClassificationOptions {
  /// [Hz], > 0 and < a quarter of rotation; a reading counts where |peak - expected| <= tolerance_hz, of chatter
  /// <= max(tolerance_hz, ζ f).
  double tolerance_hz = 1.0;
  double speed_tolerance = 2e-3;  ///< in [0, 0.05]; |true speed - commanded| <= speed_tolerance · commanded
  double clear_odds = 3.0;  ///< in [1, 1e6]; a reading is named where likelihood > clear_odds · any other meaning's
  bool multiples_removed = false;  ///< the peaks are no multiples of rotation: those were taken out before
  int most_rotations = std::numeric_limits<int>::max();  ///< >= 0; chatter's |n| <= it
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// One way to read a peak.
struct Explanation {
  /// tooth_passing: n rotations, n a multiple of the teeth. rotation: n rotations. chatter: |f_k + n rotations|.
  /// cut_or_chatter: some readings are the first or second, some the third. unexplained: none lies within its
  /// tolerance.
  enum class Kind { tooth_passing, rotation, chatter, cut_or_chatter, unexplained };
  Kind kind = Kind::unexplained;
  int harmonic = 0;         ///< n
  bool mirrored = false;    ///< f_k + n rotations is negative: the peak is -n rotations less the mode's frequency
  modal::ModeId mode = {};  ///< k; unknown but for chatter
  double mode_frequency_hz = 0.0;
  bool of_tooth_passing = false;  ///< whether n is a multiple of the teeth
  double expected_hz = 0.0;       ///< what n, the speed and the mode give
  double difference_hz = 0.0;     ///< peak less that
  double tolerance_hz = 0.0;      ///< that was allowed: the option's, or the mode's half width ζ f where that is more
  /// exp(-2 (difference/tolerance)²)/tolerance: the density of a peak that scatters by half the tolerance [1/Hz]. What
  /// allows more explains less.
  double likelihood_per_hz = 0.0;
};

struct ExplainedPeak {
  /// named: one meaning is clearly the likeliest, and `best` is its reading. ambiguous: another reading, of
  /// another mode or of the cut in place of chatter, is about as likely as the best (likelihood >= best / clear_odds);
  /// `best` holds the kind alone and the readings are `others`. unexplained: nothing lies within its tolerance.
  enum class State { named, ambiguous, unexplained };
  double frequency_hz = 0.0;
  State state = State::unexplained;
  Explanation best;
  std::vector<Explanation> others = {};  ///< the other readings within their tolerance, the most likely first
  /// The vibration's own frequency, the peak less its multiple of rotation: of chatter whose mode is named, or where
  /// all readings that are about as likely are chatter and agree on it within the tolerance; else NaN.
  double chatter_frequency_hz = std::numeric_limits<double>::quiet_NaN();
};

struct PeakClassification {
  /// named: more peaks name one mode than any other. ambiguous: there may be chatter, but no peak names its mode,
  /// or as many name one as another. no_chatter: every peak is the cut's own or unexplained.
  enum class State { named, ambiguous, no_chatter };
  double spindle_speed_rad_per_s = 0.0;  ///< that the peaks which are multiples of rotation agree on, or as commanded
  bool speed_from_peaks = false;
  std::vector<ExplainedPeak> peaks;
  State state = State::no_chatter;
  modal::ModeId mode = {};  ///< that most chatter peaks name; unknown unless named
  double chatter_frequency_hz = std::numeric_limits<double>::quiet_NaN();  ///< mean of the peaks that name it; or NaN
};

inline constexpr Name<Explanation::Kind> explanation_names[] = {{"tooth passing", Explanation::Kind::tooth_passing},
                                                                {"rotation", Explanation::Kind::rotation},
                                                                {"chatter", Explanation::Kind::chatter},
                                                                {"cut or chatter", Explanation::Kind::cut_or_chatter},
                                                                {"unexplained", Explanation::Kind::unexplained}};
inline constexpr Name<ExplainedPeak::State> peak_state_names[] = {{"named", ExplainedPeak::State::named},
                                                                  {"ambiguous", ExplainedPeak::State::ambiguous},
                                                                  {"unexplained", ExplainedPeak::State::unexplained}};
inline constexpr Name<PeakClassification::State> classification_names[] = {
    {"named", PeakClassification::State::named},
    {"ambiguous", PeakClassification::State::ambiguous},
    {"no chatter", PeakClassification::State::no_chatter}};
[[nodiscard]] ROBOMILL_API std::string_view to_string(Explanation::Kind kind);
[[nodiscard]] ROBOMILL_API std::string_view to_string(ExplainedPeak::State state);
[[nodiscard]] ROBOMILL_API std::string_view to_string(PeakClassification::State state);

/// Reads each peak. Chatter appears at f = |f_k + n f_rotation|: with equal teeth at multiples of tooth passing from
/// the mode alone, with runout at the others too. Of several readings the most likely is named, unless one that means
/// something else is about as likely; of equally likely ones a multiple of tooth passing comes first.
///
/// The speed is the commanded one, or another within speed_tolerance at which two peaks at least are multiples of
/// rotation and more peaks are explained; refined by least squares over the peaks that are named as multiples.
/// @param tool, workpiece  whose modes may chatter; a workpiece without modes stands still
/// @throws InvalidInput if an input is out of range
[[nodiscard]] ROBOMILL_API PeakClassification explain(const MeasuredPeaks& peaks, const modal::ModalModel& tool,
                                                      const PeakClassificationOptions& options = {},
                                                      const modal::ModalModel& workpiece = {});

/// Whether a cut's chatter needs the wave that the tooth before left.
struct ChatterMechanism {
  enum class Kind {
    stable,        ///< spectral_radius < 1: no chatter
    regenerative,  ///< spectral_radius >= 1, without_delay < 1: it lives on the wave that the tooth before left
    mode_coupling  ///< both >= 1: modes feed each other through the force, without that wave
  };
  Kind kind = Kind::stable;
  double spectral_radius = 0.0;       ///< of one period, as evaluate_point has it
  double without_delay = 0.0;         ///< of the same period with F = Σ_j K_j(t) q(t)
  double chatter_frequency_hz = 0.0;  ///< of the cut with the delay
  modal::ModeId mode = {};            ///< the same
};
inline constexpr Name<ChatterMechanism::Kind> mechanism_names[] = {
    {"stable", ChatterMechanism::Kind::stable},
    {"regenerative", ChatterMechanism::Kind::regenerative},
    {"mode coupling", ChatterMechanism::Kind::mode_coupling}};
[[nodiscard]] ROBOMILL_API std::string_view to_string(ChatterMechanism::Kind kind);

/// Regenerative: unstable, and stable once the delayed displacement is left out of the force. Mode coupling: unstable
/// without it too. The periodic equation without delay is integrated exactly in its modes, by Runge-Kutta's fourth
/// order in its force; every tooth cuts, at the mean speed.
/// @throws InvalidInput if the problem or the point is out of range
[[nodiscard]] ROBOMILL_API ChatterMechanism chatter_mechanism(const LobesProblem& problem, const OperatingPoint& point);

}  // namespace robomill::stability
