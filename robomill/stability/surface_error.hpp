#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "The chart"

namespace robomill::stability {

/// What the steady vibration of a stable cut leaves on the wall.
struct SurfacePoint {
  bool stable = false;  ///< where not, the rest is NaN
  /// Where the tooth's tip stands as it finishes the wall, against where a stiff tool's would [m]; positive: material
  /// is left standing. Up-milling finishes at φ = 0, down-milling at φ = π, a slot at both. Of unequal teeth and of
  /// both walls that of greatest magnitude. NaN where no tooth finishes a wall.
  double surface_location_error_m = 0.0;
  double peak_to_peak_x_m = 0.0, peak_to_peak_y_m = 0.0;  ///< of the tool's tip, at the nodes of the cut
  double peak_deflection_m = 0.0;  ///< greatest distance of the tip from rest, in the cut and between cuts
};

struct SurfaceMap {
  Eigen::VectorXd spindle_speed_rad_per_s;   ///< length n
  Eigen::VectorXd axial_depth_m;             ///< length m
  Eigen::MatrixXd surface_location_error_m;  ///< m x n, a row a depth; NaN where the cut is not stable
  Eigen::MatrixXd peak_to_peak_m;            ///< m x n, the greater of x and y; NaN where the cut is not stable
};

/// The periodic orbit under the feed's own chip, edge forces and runout: x = Φ x + p for the state of one period's
/// collocation, by a run from rest (p) and one for each entry of the state. Forces on the tool come from
/// Milling::feed_per_tooth_m.
/// @param tolerance  as LobesOptions::tolerance: of the spectral radius, |Δradius| <= tolerance · max(1, radius)
/// @throws InvalidInput if the problem or the point is out of range, or the feed or the depth is not > 0
[[nodiscard]] ROBOMILL_API SurfacePoint surface_point(const LobesProblem& problem, const OperatingPoint& point,
                                                      double tolerance = 1e-6);

/// Over the options' ranges on a grid of `grid` speeds and depths, the lowest depth being one step above the range's
/// start.
/// @throws InvalidInput as above; Interrupted
[[nodiscard]] ROBOMILL_API SurfaceMap surface_map(const LobesProblem& problem, const LobesOptions& options,
                                                  const std::array<int, 2>& grid,
                                                  Progress& progress = Progress::none());

}  // namespace robomill::stability
