#pragma once
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/stability/frequency_response.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability {

struct FrequencyOptions {
  double largest_depth_m = 0.0;  ///< greatest axial depth to look at [m], > 0; required
  /// In [1e-12, 0.1]. Multi-frequency: polynomials and harmonics grow until |Δlimit| <= tolerance · limit.
  double tolerance = 1e-7;
  bool all_crossings = false;  ///< look for every change of stability up to the greatest depth, not the first alone
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// An axial depth at which stability changes.
struct DepthCrossing {
  double axial_depth_m = 0.0;
  double chatter_frequency_hz = 0.0;  ///< of the harmonic with the greatest displacement
  BifurcationType kind = BifurcationType::hopf;
  bool opens = false;  ///< more is unstable above than below
};

/// What a frequency-domain method says of one spindle speed.
struct FrequencyLimit {
  /// found: the other members hold. stable_in_range: no depth up to largest_depth_m is unstable; they are 0.
  /// not_converged: the limit still moves by > tolerance · limit; error_estimate_m gives by how much.
  enum class Status { found, stable_in_range, not_converged };
  Status status = Status::stable_in_range;
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  double chatter_frequency_hz = 0.0;
  BifurcationType kind = BifurcationType::hopf;
  modal::ModeId mode = {};        ///< that moves most in it; unknown for measured FRFs
  double error_estimate_m = 0.0;  ///< by how much the last refinement moved the limit
  /// Share by which the limit moves where receptances outside the band of measured FRFs are left out.
  double uncovered_ratio = 0.0;
  std::vector<DepthCrossing> crossings = {};  ///< by depth: the first, or all that were asked for; with helix the first
};

/// Zeroth-order approximation: the cutting stiffness is replaced by its mean over a period,
///   det(I - a Σ_j (1 - exp(-iω τ_j)) K̄_j G(iω)) = 0,
/// with all four receptances. Solved at each given spindle speed for the frequencies ω at which a is real. Unequal
/// pitch keeps its delays; helix has no influence on the mean. Source: [Altintas1995].
/// @throws InvalidInput if an input is out of range, or for runout, speed variation, unequal helix
[[nodiscard]] std::vector<FrequencyLimit> zeroth_order_limits(const cutting::Milling& milling,
                                                              const FrequencyResponse& response,
                                                              const std::vector<double>& spindle_speeds_rad_per_s,
                                                              const FrequencyOptions& options,
                                                              Progress& progress = Progress::none());

/// Multi-frequency solution: Hill's determinant of all harmonics of the cutting stiffness and of the receptances at
/// ω + n ω_P. Converges to the exact limit. Helix, unequal pitch, process damping included. The structure without a cut
/// is taken for stable. Method and accuracy: robomill/stability/README.md. Source: [Merdol2004], [Budak1998].
/// @throws InvalidInput if an input is out of range, or for runout, speed variation, unequal helix
[[nodiscard]] std::vector<FrequencyLimit> multi_frequency_limits(const cutting::Milling& milling,
                                                                 const FrequencyResponse& response,
                                                                 const std::vector<double>& spindle_speeds_rad_per_s,
                                                                 const FrequencyOptions& options,
                                                                 Progress& progress = Progress::none());

/// @throws InvalidInput naming the band that is missing, if measured FRFs still rise towards an end of their band, or
///     if what they leave out moves a limit by more than `largest_ratio` of itself:
///     FrequencyLimit::uncovered_ratio > largest_ratio
void require_coverage(const FrequencyResponse& response, const std::vector<FrequencyLimit>& limits,
                      double largest_ratio = 0.2);

}  // namespace robomill::stability
