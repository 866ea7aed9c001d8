#pragma once
#include "robomill/base/export.hpp"
#include "robomill/cutting/engagement.hpp"

/// Feed frame F with its origin where the cutter touches the finished surface; docs/frames.md.
// Method: robomill/cutting/README.md, "Analytic engagement (`published/analytic_engagement.hpp`)"
namespace robomill::cutting {

/// Where the cutter is below the unmachined surface, outside the neighbouring pass, and moves outwards (n·x_F > 0).
/// Lead and tilt move only the cutter's own (κ, φ) over that patch.
/// @throws InvalidInput as validate; a cut that reaches the shank (lead_rad, tilt_rad, or axial_depth_m)
[[nodiscard]] ROBOMILL_API Engagement engage(const Cutter& cutter, const Cut& cut,
                                             const EngagementOptions& options = {});

}  // namespace robomill::cutting
