#pragma once
#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "The chart"

namespace robomill::stability {

inline constexpr double no_surface = std::numeric_limits<double>::quiet_NaN();

/// Where an edge leaves the finished surface, and how far from a stiff tool's.
struct SurfacePlace {
  /// By how much the surface falls short of that of a stiff tool, along its normal [m]; positive: material is left
  /// standing. NaN: there is no such place.
  double error_m = no_surface;
  double normal_rad = no_surface;    ///< of the cutter's outward normal, from -z_F towards y_F: 0 a floor, π/2 a wall
  double position_rad = no_surface;  ///< κ on the cutter
  double angle_rad = no_surface;     ///< φ at which an edge passes it
  double height_m = no_surface;      ///< above the tip, along the tool's axis
  double radius_m = no_surface;      ///< from that axis; the place is (r sin φ, r cos φ, height) in T
  int tooth = -1;                    ///< that leaves it, from 0; of equal teeth the first
};

/// What the steady vibration of a stable cut leaves.
struct SurfacePoint {
  bool stable = false;  ///< where not, the rest is NaN
  /// Where the tooth stands as it finishes the surface, against where a stiff tool's would [m]; positive: material is
  /// left standing. Of unequal teeth that which reaches farthest. NaN where no tooth finishes a surface.
  ///   In the plane at the tooth's tip: up-milling finishes the wall at φ = 0, down-milling at φ = π, a slot both, of
  /// which the error of greatest magnitude counts.
  ///   In three directions that of greatest magnitude over the profile that remains (`place`), along its normal.
  double surface_location_error_m = no_surface;
  double peak_to_peak_x_m = no_surface,
         peak_to_peak_y_m = no_surface;   ///< of the tool's tip; plane: at nodes of the cut
  double peak_to_peak_z_m = no_surface;   ///< in the plane 0
  double peak_deflection_m = no_surface;  ///< greatest distance of the tip from rest, in the cut and between cuts
  /// In three directions: about the mean. In the plane ForcedResponse knows it.
  ForcedVibration vibration = {};
  SurfacePlace place = {};  ///< where the error is
  /// In three directions: the next pass, as far on as the one before, does not take the place away again. false:
  /// nothing would remain, and the pass is taken for the last one; or the engagement is given, and later passes are not
  /// known.
  bool remains = false;
};

struct SurfaceMap {
  Eigen::VectorXd spindle_speed_rad_per_s;   ///< length n
  Eigen::VectorXd axial_depth_m;             ///< length m
  Eigen::MatrixXd surface_location_error_m;  ///< m x n, a row a depth; NaN where the cut is not stable
  Eigen::MatrixXd peak_to_peak_m;            ///< m x n, the greatest of x, y and z; NaN where the cut is not stable
};

/// The steady motion under the feed's own chip, edge forces and runout, and what it leaves. In the plane the periodic
/// orbit x = Φ x + p for the state of one period's collocation, by a run from rest (p) and one for each entry of the
/// state. In three directions the structure's exact answer to the steady force, with what unequal teeth regenerate by
/// collocation; derivation in docs/theory/three-directions.md. Forces on the tool come from feed_per_tooth_m.
/// @param tolerance  as LobesOptions::tolerance: of the spectral radius, |Δradius| <= tolerance · max(1, radius)
/// @throws InvalidInput if the problem or the point is out of range, the feed or the depth is not > 0, of drilling, or
/// of measured FRFs in place of modes
[[nodiscard]] ROBOMILL_API SurfacePoint surface_point(const LobesProblem& problem, const OperatingPoint& point,
                                                      double tolerance = 1e-6);

/// The same of a cut that is known to be stable: its spectral radius is not looked at.
/// @throws InvalidInput as above
[[nodiscard]] ROBOMILL_API SurfacePoint surface_of_stable_cut(const LobesProblem& problem, const OperatingPoint& point,
                                                              double tolerance = 1e-6);

/// Of a cut in three directions that is known to be stable: place by place along the profile that remains, first on the
/// side away from y_F. Empty where no tooth finishes a surface.
/// @throws InvalidInput as above, or of a cut in the plane
[[nodiscard]] ROBOMILL_API std::vector<SurfacePlace> surface_profile(const LobesProblem& problem,
                                                                     const OperatingPoint& point,
                                                                     double tolerance = 1e-6);

/// What a stable cut in three directions leaves, and how its tip vibrates.
struct SteadyCut {
  std::vector<SurfacePlace> profile = {};  ///< as surface_profile
  ForcedVibration vibration = {};          ///< as ForcedResponse::at
};
/// Both from one steady motion.
/// @throws InvalidInput as surface_profile
[[nodiscard]] ROBOMILL_API SteadyCut steady_cut(const LobesProblem& problem, const OperatingPoint& point,
                                                double tolerance = 1e-6);

/// Over the options' ranges on a grid of `grid` speeds and depths, the lowest depth being one step above the range's
/// start.
/// @throws InvalidInput as above; Interrupted
[[nodiscard]] ROBOMILL_API SurfaceMap surface_map(const LobesProblem& problem, const LobesOptions& options,
                                                  const std::array<int, 2>& grid,
                                                  Progress& progress = Progress::none());

}  // namespace robomill::stability
