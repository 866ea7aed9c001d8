#pragma once
#include <vector>

#include "robomill/stability/collocation/mesh/silhouette.hpp"
#include "robomill/stability/spatial.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

struct FinishedProfile {
  std::vector<SilhouettePoint> places;  ///< in the order of the profile, side by side
  /// Whether the next pass is known not to take them away again. Else they are all that the pass leaves.
  bool remains = false;
};

/// Where the edges of a pass leave the finished surface: places of the silhouette that are in the cut.
///
/// Of a milling.cut: below the unmachined surface and outside the neighbouring pass; of these those that the next pass,
/// as far on the other side, does not reach. Where there are none, as of an upright flat end, the pass is taken for the
/// last one, and all remain. Of a milling.engagement: where an arc ends on the silhouette; what later passes do is not
/// known.
/// @param depth_m       in place of that of the cut
/// @param engagement    at that depth
/// @param step_rad      of rotation, from place to place
[[nodiscard]] FinishedProfile finished_profile(const SpatialMilling& milling, double depth_m,
                                               const cutting::Engagement& engagement, double step_rad);

}  // namespace robomill::stability::detail
