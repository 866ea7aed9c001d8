#pragma once
#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/modal/README.md, "Hammer hits to FRFs (`hits.hpp`)"

namespace robomill::modal {

/// What the response channels of a hit hold.
enum class ResponseKind {
  acceleration,  ///< [m/s²]; receptance = ratio / s², s = iω, or iω + σ where the window's decay σ stays in
  velocity,      ///< [m/s]; receptance = ratio / s
  displacement   ///< [m]; the ratio is the receptance
};

/// H1 = Σ X F* / Σ |F|² (no bias from noise on the response), H2 = Σ |X|² / Σ F X* (no bias from noise on the force),
/// Hv = their geometric mean: total least squares with force and response scaled to equal power. [Rocklin1985]
enum class Estimator { h1, h2, hv };

/// Whether force and responses are multiplied by exp(-t/τ), so that responses that outlast the record do not leak.
enum class ExponentialWindow {
  automatic,  ///< where a record ends with > 2 % of a response's vibration left
  off,        ///< never; what is left leaks
  on          ///< always
};

/// One response of a hit.
struct HitChannel {
  Dof dof;
  Eigen::VectorXd samples;    ///< as long as the force; in the SI unit of HitOptions::response
  bool against_axis = false;  ///< the sensor points against the axis of dof
};

/// One record of one hit with an instrumented hammer.
struct Hit {
  std::string file;             ///< where it was read from; names the hit in verdicts and messages
  Dof excitation;               ///< where and along which axis the hammer hit
  bool against_axis = false;    ///< the hammer pushed against the axis of excitation
  double sample_rate_hz = 0.0;  ///< > 0; required
  Eigen::VectorXd force_n;      ///< length n; a push reads positive, whichever way it goes along the axis
  std::vector<HitChannel> responses;
  std::string fault = {};  ///< of the record as it was cut out of a longer one: rejects the hit; empty: none
};

struct HitOptions {
  ResponseKind response = ResponseKind::acceleration;
  Estimator estimator = Estimator::h1;
  double accelerometer_mass_kg = 0.0;  ///< >= 0; taken out of the FRFs
  /// Lowest line that is given, f >= min_frequency_hz; 0: the first above zero, which has no double integral.
  double min_frequency_hz = 0.0;
  double max_frequency_hz = 0.0;         ///< highest line that is given, f <= this; 0: sample rate / 2.56
  double frequency_resolution_hz = 0.0;  ///< 0: 1 / record length; coarser cuts the records, finer pads them with zeros
  double force_overload_n = 0.0;         ///< max |force| >= this rejects the hit; 0: only flat tops do
  double response_overload = 0.0;        ///< the same for responses, in the SI unit of `response`
  double double_hit_limit = 0.03;        ///< in (0, 1]; second pulse / first > this rejects the hit
  bool force_window = true;              ///< zero the force outside the pulse
  double force_window_s = 0.0;           ///< length of the force window; 0: from the pulse
  ExponentialWindow exponential_window = ExponentialWindow::automatic;  ///< automatic: where a response has not decayed
  /// τ of exp(-t/τ); 0: so that what still rings at the record's end is brought down to 0.5 % there, and with `on` that
  /// it falls to 5 % at least.
  double exponential_time_constant_s = 0.0;
  bool remove_added_damping = true;  ///< take what the exponential window adds out of the FRFs again

  /// @throws InvalidInput naming the field
  ROBOMILL_API void validate() const;
};

/// What became of one hit.
struct HitVerdict {
  std::string file;
  bool accepted = false;
  std::vector<std::string> reasons;  ///< why it was rejected; empty where it was accepted
  double peak_force_n = 0.0;
  double pulse_width_s = 0.0;       ///< full width of the pulse at half its peak
  double second_pulse_ratio = 0.0;  ///< highest further pulse / first
};

/// How far an FRF is to be trusted, by the worst of its faults.
enum class Grade {
  good,    ///< no fault
  usable,  ///< minor faults alone: mean coherence < 0.95, fewer than 3 hits, Im H > 0, reciprocity error > 20 %, …
  poor     ///< mean coherence < 0.8, noise > 30 % of |H| (from one hit), or no line that can be trusted
};
/// "good", "usable", "poor"
[[nodiscard]] ROBOMILL_API std::string to_string(Grade grade);

/// A resonance in the magnitude of an FRF.
struct FrfPeak {
  double frequency_hz = 0.0;
  double receptance_m_per_n = 0.0;
};

/// How far one FRF is to be trusted before any fit, and what to do about it. Unknown numbers are NaN.
struct FrfGrade {
  FrfName name;
  Grade grade = Grade::poor;
  int hits = 0;                                                         ///< averaged
  double mean_coherence = std::numeric_limits<double>::quiet_NaN();     ///< over the band below; unknown from one hit
  double relative_noise = std::numeric_limits<double>::quiet_NaN();     ///< median of deviation / |H| over the band
  double reciprocity_error = std::numeric_limits<double>::quiet_NaN();  ///< ‖H_xy − H_yx‖ / mean norm over the band
  double excited_low_hz = 0.0;                                          ///< band that the hammer excites:
  double excited_high_hz = 0.0;                                         ///< force spectrum within 20 dB of its highest
  double lowest_trustworthy_frequency_hz = 0.0;
  std::vector<FrfPeak> peaks;         ///< the highest six within the band that can be trusted, by frequency
  std::vector<std::string> faults;    ///< "the hammer excites nothing above 800 Hz"
  std::vector<std::string> remedies;  ///< as long as faults: "use a harder tip"
};

struct FrfResult {
  FrfSet set;
  std::vector<HitVerdict> hits;  ///< one for each hit, in their order
  /// Above it every FRF is ruled by the structure, below it one at least by the noise of the sensors.
  double lowest_trustworthy_frequency_hz = 0.0;
  double added_decay_per_s = 0.0;    ///< 1/τ of the exponential window; 0 where none was needed
  bool added_decay_removed = false;  ///< whether `set` is free of it (else FitOptions::exponential_decay_per_s)
  std::vector<FrfGrade> grades;      ///< one for each FRF of the set, in its order
  std::vector<std::string> notes;    ///< what a reader of the result must know: windows, mass, resolution
  /// Where modes can be fitted without more being said: from lowest_trustworthy_frequency_hz to the highest frequency
  /// that some hit excites, infinity where none lies above it [Hz].
  [[nodiscard]] ROBOMILL_API std::array<double, 2> band_hz() const;
};

/// Receptances from hammer hits: accepted hits of each excitation are averaged (`estimator`), integrated to
/// displacement, freed of the accelerometer's mass and of the exponential window's damping. x and y hits with x and y
/// responses give xx, yx, xy, yy.
///
/// @throws InvalidInput if hits is empty, a record is too short, holds a value that is not finite or a force of zeros,
/// lengths or sample rates differ, a response comes twice, or no hit is accepted (with the reasons) Source: [Ewins2000]
/// ch. 3; equations in robomill/modal/README.md
[[nodiscard]] ROBOMILL_API FrfResult estimate_frfs(const std::vector<Hit>& hits, const HitOptions& options,
                                                   Progress& progress = Progress::none());

}  // namespace robomill::modal
