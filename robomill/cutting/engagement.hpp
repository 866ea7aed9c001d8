#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"

/// Feed frame F: x along the feed, y to its left, z along the surface's normal towards the spindle; docs/frames.md.
namespace robomill::cutting {

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
  double width_m = 0.0;                ///< db, along the meridian: width of cut
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

/// Rx(tilt) Ry(lead): P_F = R P_T.
[[nodiscard]] ROBOMILL_API Eigen::Matrix3d feed_from_tool(double lead_rad, double tilt_rad);

/// Area of the envelope in the cut, ∫ dA with dA = r dφ db [m²].
[[nodiscard]] ROBOMILL_API double patch_area_m2(const Engagement& engagement);
/// Area of the chip across the feed, ∫ (n·x_F) dA [m²], in closed form over each arc. Removal is feed times this.
[[nodiscard]] ROBOMILL_API double chip_area_m2(const Engagement& engagement);

}  // namespace robomill::cutting
