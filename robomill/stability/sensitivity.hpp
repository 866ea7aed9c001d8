#pragma once
#include <vector>

#include "robomill/stability/lobes.hpp"

namespace robomill::stability {

/// How the spectral radius at a point answers small relative changes of what the structure is made of.
struct LimitSensitivity {
  struct OfMode {
    modal::ModeId mode = {};
    double frequency = 0.0;      ///< ∂ ln|μ| / ∂ ln f, vectors held
    double damping_ratio = 0.0;  ///< ∂ ln|μ| / ∂ ln ζ
    double residue = 0.0;        ///< ∂ ln|μ| / ∂ ln ‖residue‖
  };
  std::vector<OfMode> modes;  ///< those that take part: the tool's, then the workpiece's
  double depth = 0.0;         ///< ∂ ln|μ| / ∂ ln a; > 0 where a deeper cut is less stable
};

/// At one point, by collocation. With equal teeth and an even speed from the left and right eigenvectors of the period
/// over the modes, else from differences of radii.
/// @param tolerance  as LobesOptions::tolerance
/// @throws InvalidInput as evaluate_point
[[nodiscard]] LimitSensitivity limit_sensitivity(const LobesProblem& problem, const OperatingPoint& point,
                                                 double tolerance = 1e-6);

/// Depths below which 5, 50 and 95 % of the limits lie [m].
struct LimitQuantiles {
  double limit_5_percent_m = 0.0, limit_50_percent_m = 0.0, limit_95_percent_m = 0.0;
  double log_std = 0.0;  ///< standard deviation of ln limit
};

/// To the first order: ln limit is normal about ln a, with the standard deviation of Σ (∂ ln|μ|/∂p) δp over
/// ∂ ln|μ|/∂ ln a; the modes' own frequency_std_hz, damping_ratio_std and residue_std_ratio are independent and normal,
/// those that are not known count as 0. Where the radius does not grow with the depth all three are the limit itself.
/// @param limit_m  a [m], where |μ| = 1
[[nodiscard]] LimitQuantiles limit_quantiles(const LobesProblem& problem, const LimitSensitivity& sensitivity,
                                             double limit_m);

}  // namespace robomill::stability
