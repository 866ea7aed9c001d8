#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "FRFs to modes (`fit.hpp`)"

namespace robomill::modal {

/// How modes are found.
enum class FitMethod {
  hybrid,  ///< poles of lscf, then weighted nonlinear least squares over all FRFs; order by an information criterion
  pso,     ///< particle swarm, one fit an excitation, as published
  lscf     ///< poly-reference least-squares complex frequency, poles picked from the stabilisation diagram
};
inline constexpr Name<FitMethod> fit_method_names[] = {
    {"hybrid", FitMethod::hybrid}, {"pso", FitMethod::pso}, {"lscf", FitMethod::lscf}};

/// What a line's error is taken to be; each line counts by its inverse.
enum class Weighting {
  automatic,  ///< deviation where every FRF has it, else coherence where every FRF has it, else estimated
  none,       ///< the same on every line of an FRF and on every FRF
  relative,   ///< proportional to |H|
  coherence,  ///< |H| sqrt((1 - γ²) / γ²), γ² smoothed
  deviation,  ///< Frf::deviation, smoothed
  estimated   ///< sqrt(a² + b² |H|²), a and b an FRF from the scatter between neighbouring lines
};

/// What to fit and how.
struct FitOptions {
  FitMethod method = FitMethod::hybrid;
  double band_low_hz = 0.0;                                       ///< >= 0 [Hz]
  double band_high_hz = std::numeric_limits<double>::infinity();  ///< > band_low_hz [Hz]; infinite: to the last line
  int modes = 0;       ///< exactly so many modes; 0: as many as the data shows
  int max_modes = 20;  ///< at most so many where `modes` is 0, in 1 … 60
  Weighting weighting = Weighting::automatic;
  bool residuals =
      true;  ///< allow mass and stiffness residuals for modes outside the band; hybrid drops them if not needed
  double max_damping_ratio = 0.4;  ///< no mode of hybrid or lscf above it, in (0, 1)
  /// Subtracted from every pole's decay after the fit [1/s], >= 0: 1/τ where the hits had the window exp(-t/τ): λ -> λ
  /// + 1/τ.
  double exponential_decay_per_s = 0.0;
  std::uint64_t seed = 1;  ///< of pso

  int lscf_max_order = 40;         ///< highest polynomial order of the stabilisation diagram, in 2 … 200
  double stable_frequency = 0.01;  ///< a pole is stable if it moved less than this share of its frequency, > 0 …
  double stable_damping = 0.05;    ///< … its damping ratio less than this share, > 0 …
  double stable_mac = 0.95;        ///< … and MAC(left) · MAC(right) with the one before is above this, in [0, 1]

  // Of the swarm (published/pso.hpp), which takes its defaults from here.
  int pso_particles = 400;                ///< >= 2
  int pso_max_iterations = 8000;          ///< >= 1
  double pso_frequency_half_width = 0.1;  ///< a mode stays within (1 ± this) of its peak, in (0, 1)
  double pso_max_damping_ratio = 0.1;     ///< no mode of the swarm above it, in (0, 1]
  double pso_inertia_start = 0.9;         ///< in [0, 1]
  double pso_inertia_end = 0.4;           ///< in [0, pso_inertia_start]
  int pso_inertia_iterations = 300;       ///< over which it falls, >= 1
  double pso_cognitive = 2.0;             ///< c1, pull of a particle's own best, in [0, 100]
  double pso_social = 2.0;                ///< c2, pull of the swarm's best, in [0, 100]
  double pso_velocity_fraction = 0.1;     ///< no velocity above this share of its range, in [0, 1], 0: no bound

  /// @throws InvalidInput naming the field
  ROBOMILL_API void validate() const;
};

/// One pole of the stabilisation diagram, against the nearest one of the order below.
struct StabilisationPoint {
  int order = 0;
  double frequency_hz = 0.0, damping_ratio = 0.0;
  bool frequency_stable = false, damping_stable = false, vector_stable = false;
};

/// From this relative error on a fit has a warning: relative_error >= doubtful_fit_error …
constexpr double doubtful_fit_error = 0.05;
/// … and from this one on, relative_error >= unusable_fit_error, its modes do not describe the FRFs: only who accepts
/// that may use them.
constexpr double unusable_fit_error = 0.2;

/// A bound that the search for a mode ended at: what stands there is no mode that the data shows.
enum class FitBound {
  damping,        ///< FitOptions::max_damping_ratio: ζ >= 0.999 · bound
  swarm_damping,  ///< FitOptions::pso_max_damping_ratio, where the swarm fitted: ζ >= 0.999 · bound
  band_low,       ///< the first line of the band: f <= line + half the lines' mean distance
  band_high       ///< the last line of the band: f >= line - half the lines' mean distance
};
/// The name of the option: "max_damping_ratio", "pso_max_damping_ratio", "band_low_hz" or "band_high_hz".
[[nodiscard]] ROBOMILL_API const char* to_string(FitBound bound);
struct ModeAtBound {
  int mode = 0;  ///< from 1
  FitBound bound = FitBound::damping;
};

/// How far fit and data are apart on one FRF.
struct FrfFitError {
  FrfName name;
  double relative = 0.0;  ///< ‖H_fit - H‖ / ‖H‖ over the band
};

/// The modes and how well they describe the FRFs.
struct FitResult {
  /// converged: there are modes, as many as asked for, and the search ended by itself. hybrid: the last refinement met
  /// its tolerance. pso: the best misfit of each swarm fell by <= 0.1 % of itself in 20 iterations. not_converged:
  /// else; the model is the best one found, and may hold no mode.
  enum class Status { converged, not_converged };
  Status status = Status::not_converged;
  ModalModel model;                  ///< modes by rising frequency, normalised
  double relative_error = 0.0;       ///< ‖H_fit - H‖ / ‖H‖ over the band and all FRFs, residuals included
  double mean_relative_error = 0.0;  ///< mean over lines and FRFs of |H_fit - H| / |H|, residuals included
  std::vector<FrfFitError> by_frf;   ///< in the order of the input
  std::vector<ModeAtBound> at_bounds;
  std::vector<double> dropped_hz;  ///< weak modes without which the fit is as good, and which are not in the model
  bool accepted = false;           ///< somebody takes the modes whatever their error
  int iterations = 0;
  /// The objective after each iteration. pso: mean relative error; hybrid: the relative error with lines weighted,
  /// which jumps where the weights are estimated anew or a mode comes or goes, part after part.
  std::vector<double> best;
  std::vector<StabilisationPoint> stabilisation;  ///< hybrid and lscf
  double band_low_hz = 0.0, band_high_hz = 0.0;   ///< first and last line used [Hz]
  Eigen::Index lines = 0;                         ///< number of lines used
  Weighting weighting = Weighting::none;          ///< the one used, never `automatic`
  std::vector<std::string> warnings;              ///< sentences for the user

  /// Whether the modes describe the FRFs, or somebody takes them as they are.
  [[nodiscard]] bool usable() const { return accepted || relative_error < unusable_fit_error; }
  /// The bounds that a mode stands at.
  /// @param mode  from 1
  [[nodiscard]] ROBOMILL_API std::vector<FitBound> bounds_of(int mode) const;
};

/// Finds the modes of FRFs: H_ij(ω) = Σ_k R_ik L_jk / (iω - λ_k) + conjugate + mass_ij / (-ω²) + stiffness_ij.
///
/// The set may hold any FRFs. An FRF that is missing follows from the others where they determine it (xx, yx, yy give
/// xy); FRFs that share neither response nor excitation (xx, yy) are fitted apart, their cross FRFs are taken as zero,
/// and a warning says so. A line at 0 Hz is left out. A fit that is not passive or not reciprocal is a fit with a
/// warning. Steps and measured accuracy in README.md.
/// @throws InvalidInput if an option or the set is not valid, the band holds too few lines for the modes asked for, or
/// the
///         weighting asked for has no data
/// Source: [Peeters2004] (lscf), [GolubPereyra2003] (variable projection)
[[nodiscard]] ROBOMILL_API FitResult fit_modes(const FrfSet& set, const FitOptions& options,
                                               Progress& progress = Progress::none());

}  // namespace robomill::modal
