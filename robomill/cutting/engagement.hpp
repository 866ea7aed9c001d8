#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/milling.hpp"

/// Feed frame F: x along the feed, y to its left, z along the surface's normal towards the spindle, origin where the
/// cutter touches the finished surface; docs/frames.md.
// Method: robomill/cutting/README.md, "Analytic engagement (`engagement.hpp`)"
namespace robomill::cutting {

/// A pass beside another one over a plane, or over a cylinder that the surface is like nearby.
struct ROBOMILL_API Cut {
  double axial_depth_m = 0.0;   ///< h: of the unmachined surface above the lowest point of the finished one [m], > 0
  double radial_depth_m = 0.0;  ///< l: step-over, from the neighbouring pass along the surface [m], in (0, 2 r], r the
                                ///< cutter's largest radius; a slot has no neighbour and ignores it
  MillingDirection direction = MillingDirection::up;  ///< up: the neighbouring pass lies at -y; down: at +y
  double lead_rad = 0.0;                              ///< |lead| < 0.48 π; P_F = Rx(tilt) Ry(lead) P_T
  double tilt_rad = 0.0;                              ///< |tilt| < 0.48 π
  double curvature_along_feed_per_m = 0.0;            ///< of the finished surface, > 0: convex. Ball ends only [1/m]
  /// One of the two curvatures k may differ from 0 [1/m]: k max(h, D/2 of a ball end) > -0.999, and |k| l < 1 but for a
  /// slot.
  double curvature_across_feed_per_m = 0.0;
  /// @throws InvalidInput naming the member
  void validate(const Cutter& cutter) const;
};

struct ROBOMILL_API EngagementOptions {
  int slices = 0;  ///< rings, at most 10,000; 0: as many as area and force need
  /// > 0: in place of slices, rings in each stretch of the profile along which the arcs change smoothly, at most 1,000.
  /// Integrals over the patch then converge exponentially with it.
  int rings_per_stretch = 0;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A range of tooth angles φ in T.
struct Arc {
  double entry_rad = 0.0;  ///< in [0, 2π)
  double exit_rad = 0.0;   ///< in (entry, entry + 2π]
};

/// A ring of the cutter's envelope.
struct EdgeSlice {
  double radius_m = 0.0;               ///< r
  double height_m = 0.0;               ///< above the tip
  double position_rad = 0.0;           ///< κ: outward normal n = (sin κ sin φ, sin κ cos φ, -cos κ) in T
  double width_m = 0.0;                ///< db, along the profile: width of cut
  double edge_length_per_width = 1.0;  ///< ds / db of the helical edge, of the first tooth
};

/// Where the cutter touches material: on each ring the angles in the cut.
struct ROBOMILL_API Engagement {
  std::vector<EdgeSlice> slices = {};
  std::vector<Arc> arcs = {};               ///< of all slices, in their order
  std::vector<std::size_t> first_arc = {};  ///< length slices + 1: slice i has [first_arc[i], first_arc[i + 1])
  Eigen::Matrix3d feed_from_tool = Eigen::Matrix3d::Identity();  ///< R of P_F = R P_T
  [[nodiscard]] std::span<const Arc> of(std::size_t slice) const {
    return std::span(arcs).subspan(first_arc[slice], first_arc[slice + 1] - first_arc[slice]);
  }
  [[nodiscard]] bool empty() const { return arcs.empty(); }
};

/// Where the cutter is below the unmachined surface, outside the neighbouring pass, and moves outwards (n·x_F > 0).
/// Lead and tilt move only the cutter's own (κ, φ) over that patch [BallEndRobot]; in published/.
/// @throws InvalidInput as validate; a cut that reaches the shank (lead_rad, tilt_rad, or axial_depth_m)
[[nodiscard]] ROBOMILL_API Engagement engage(const Cutter& cutter, const Cut& cut,
                                             const EngagementOptions& options = {});

/// Rx(tilt) Ry(lead): P_F = R P_T.
[[nodiscard]] ROBOMILL_API Eigen::Matrix3d feed_from_tool(double lead_rad, double tilt_rad);

/// Area of the envelope in the cut, ∫ dA with dA = r dφ db [m²].
[[nodiscard]] ROBOMILL_API double patch_area_m2(const Engagement& engagement);
/// Area of the chip across the feed, ∫ (n·x_F) dA [m²], in closed form over each arc. Removal is feed times this.
[[nodiscard]] ROBOMILL_API double chip_area_m2(const Engagement& engagement);
/// Greatest n·x_F over the arcs: chip thickness over the feed per tooth, without runout; 0 of an empty engagement.
[[nodiscard]] ROBOMILL_API double greatest_chip_share(const Engagement& engagement);

}  // namespace robomill::cutting
