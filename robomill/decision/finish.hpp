#pragma once
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/decision/README.md, "Forced vibration (`finish.hpp`)"

namespace robomill::decision {

/// What forced vibration may do in a finishing cut. 0: no limit; both 0: roughing.
struct FinishLimits {
  double max_surface_error_m = 0.0;  ///< >= 0; |stability::SurfacePoint::surface_location_error_m| <= this
  double max_deflection_m = 0.0;     ///< >= 0; stability::SurfacePoint::peak_deflection_m <= this
  [[nodiscard]] bool any() const { return max_surface_error_m > 0.0 || max_deflection_m > 0.0; }
  ROBOMILL_API void validate() const;  ///< throws InvalidInput naming the field
};

/// @throws InvalidInput if a limit is out of range, or the cut finishes no wall, or what it leaves cannot be computed:
/// of measured FRFs without modes
ROBOMILL_API void require_finishable(const stability::LobesProblem& problem, const FinishLimits& limits);

/// The greatest depth, up to `deepest_m`, at which a cut keeps the limits: six depths are looked at from the shallowest
/// on, and the first that does not keep them is narrowed down by halving until broken - kept <= 0.02 · broken (12 times
/// at most).
/// @throws InvalidInput as stability::surface_point
[[nodiscard]] ROBOMILL_API FinishDepth finish_depth(const stability::LobesProblem& problem,
                                                    double spindle_speed_rad_per_s, double deepest_m,
                                                    const FinishLimits& limits);

/// The same for any cut, roughing too: at which the amplitude of forced vibration is at most the feed per tooth. Beyond
/// it teeth leave the cut and meet it again, which neither force nor stability of the linear cut describe.
/// @throws InvalidInput as stability::ForcedResponse::at
[[nodiscard]] ROBOMILL_API FinishDepth vibration_depth(const stability::ForcedResponse& response,
                                                       double spindle_speed_rad_per_s, double deepest_m,
                                                       double feed_per_tooth_m);

/// Of each speed of a chart the lowest of these depths at it and on the way to its neighbours, in steps of 0.5 % (four
/// at most); deepest_m where nothing limits it. Between two speeds no depth is lower than that of either.
/// @param spindle_speed_rad_per_s  increasing
/// @throws InvalidInput as stability::ForcedResponse; Interrupted
[[nodiscard]] ROBOMILL_API std::vector<double> vibration_depths(const stability::LobesProblem& problem,
                                                                std::span<const double> spindle_speed_rad_per_s,
                                                                double deepest_m,
                                                                Progress& progress = Progress::none());

}  // namespace robomill::decision
