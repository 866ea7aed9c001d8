#pragma once
#include <optional>

#include "robomill/cutting/engagement.hpp"

namespace robomill::stability::detail {

/// An engagement that was found at one depth, as the engagement of others.
///
/// The depth is the height of the engaged part along the tool's axis. A lesser one clips the patch that much above its
/// lowest place; a ring that is cut in part keeps its part of the width, so that the force is continuous in the depth.
/// With a greater one the arcs go on upwards at the same angles, to the end of the edges: those of the widest ring in
/// the upper quarter of the height, since a leaning patch ends in a corner.
class GivenEngagement {
 public:
  /// Neighbouring rings that are alike are taken together (merged_rings).
  GivenEngagement(const cutting::Cutter& cutter, const cutting::Engagement& engagement);
  /// Height of the engaged part along the axis, of the rings' own extents [m].
  [[nodiscard]] double depth_m() const { return high_m_ - low_m_; }
  /// @param rings  in each stretch of the profile above what was found
  [[nodiscard]] cutting::Engagement at(double depth_m, int rings) const;

 private:
  void extend(double to_m, int rings, cutting::Engagement& out) const;

  cutting::Profile profile_;
  cutting::FlatEndMill mill_;
  cutting::Engagement engagement_;
  double low_m_ = 0.0, high_m_ = 0.0;
  std::size_t upper_ = 0;  ///< the ring whose arcs go on
};

/// Neighbouring rings as one where they have as many arcs, whose ends differ by less than a degree, κ grows by less
/// than a degree and the edge lags by less than two.
cutting::Engagement merged_rings(const cutting::Cutter& cutter, const cutting::Engagement& engagement);

}  // namespace robomill::stability::detail
