#pragma once
#include <array>

#include "robomill/base/export.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/regime.hpp"
#include "robomill/stability/sweep.hpp"

// Method: robomill/stability/README.md, "One block (`block.hpp`)"

namespace robomill::stability {

/// What is asked of one block of a program.
struct ROBOMILL_API BlockOptions {
  double tolerance = 1e-4;  ///< as of LobesOptions: of the spectral radii, and of |μ| = 1 at limit and margin
  /// Where the limit is looked for [m], increasing; {0, 0}: from a sixteenth of the depth to eight times it; of an
  /// analytic cut to half the height of the edges at most.
  std::array<double, 2> axial_depth_m = {0.0, 0.0};
  double most_gain = 16.0;  ///< up to which the gain margin is looked for, in [2, 1000]; its reciprocal is the least
  bool point = true;        ///< else `at` says nothing
  bool margin = true;       ///< else `gain` is not looked for, and at.gain_margin is NaN
  bool regime = true;
  bool quantiles = true;  ///< from the deviations that the modes know of themselves
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The stability of one block: a cut with its speed and depth.
struct BlockStability {
  PointResult at;  ///< as it is cut, with gain_margin (infinity: none) and limit_depth_m: those of `gain` and `limit`
  /// The lowest unstable depth; stable_in_range: none in the range. Unstable already at the least depth: that one.
  Limit limit;
  GainMargin gain;  ///< unconditionally_stable: no factor up to most_gain; below_range: unstable at its reciprocal
  Regime regime = Regime::stable;  ///< at the limit; of a cut that is unstable without a limit found, there
  bool lower_bound = false;        ///< as of RegimeResult: process damping would raise the limit
  /// Depths below which 5, 50 and 95 % of the limits lie, to the first order (limit_quantiles); infinity where there is
  /// no limit in the range, the limit itself where nothing is asked or known of deviations.
  double limit_5_percent_m = 0.0, limit_95_percent_m = 0.0;
  std::array<double, 2> searched_depth_m = {0.0, 0.0};  ///< where the limit was looked for [m]
  long long evaluations = 0;                            ///< spectral radii found
  [[nodiscard]] bool limited() const { return limit.status == Limit::Status::found; }
  /// Unstable already at the least depth that was searched, which stands as the limit.
  [[nodiscard]] bool below_range() const { return limited() && limit.axial_depth_m <= searched_depth_m[0]; }
  /// Of the motion at the limit; without one, of the least damped motion of the cut as it is.
  [[nodiscard]] double chatter_frequency_hz() const {
    return limited() ? limit.chatter_frequency_hz : at.chatter_frequency_hz;
  }
  [[nodiscard]] modal::ModeId mode() const { return limited() ? limit.mode : at.mode; }
};

/// Radius, lowest limit depth, gain margin, regime and quantiles of one cut. Depths and gains are looked at in steps of
/// the square root of two from half the cut on and of four below, closer about where the margin points to, and where
/// the radius has a peak near 1 between two of them; what is narrower than a step and stays below it is not seen.
/// @param axial_depth_m  a [m], > 0; of a given engagement its engaged_height_m
/// @throws InvalidInput as evaluate_point, or if an option is out of range
[[nodiscard]] ROBOMILL_API BlockStability block_stability(const LobesProblem& problem, double spindle_speed_rad_per_s,
                                                          double axial_depth_m, const BlockOptions& options = {});

}  // namespace robomill::stability
