#pragma once
#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/milling.hpp"

/// Feed frame F with its origin where the cutter touches the finished surface; docs/frames.md.
namespace robomill::cutting {

/// A pass beside another one over a plane, or over a cylinder that the surface is like nearby.
struct ROBOMILL_API Cut {
  double axial_depth_m = 0.0;   ///< h: of the unmachined surface above the lowest point of the finished one [m], > 0
  double radial_depth_m = 0.0;  ///< l: step-over, from the neighbouring pass along the surface [m], in (0, D]; a slot
                                ///< has no neighbour and ignores it
  MillingDirection direction = MillingDirection::up;  ///< up: the neighbouring pass lies at -y; down: at +y
  double lead_rad = 0.0;                              ///< P_F = Rx(tilt) Ry(lead) P_T
  double tilt_rad = 0.0;
  double curvature_along_feed_per_m = 0.0;   ///< of the finished surface, > 0: convex. Ball ends only [1/m]
  double curvature_across_feed_per_m = 0.0;  ///< one of the two may differ from 0 [1/m]
  /// @throws InvalidInput naming the member
  void validate(const Cutter& cutter) const;
};

struct ROBOMILL_API EngagementOptions {
  int slices = 0;  ///< rings, at most 10,000; 0: as many as area and force need
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Where the cutter is below the unmachined surface, outside the neighbouring pass, and moves outwards (n·x_F > 0).
/// Lead and tilt move only the cutter's own (κ, φ) over that patch.
/// @throws InvalidInput as validate; a cut that reaches the shank (lead_rad, tilt_rad, or axial_depth_m)
[[nodiscard]] ROBOMILL_API Engagement engage(const Cutter& cutter, const Cut& cut,
                                             const EngagementOptions& options = {});

}  // namespace robomill::cutting
