#include "robomill/stability/spatial.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"

namespace robomill::stability {

namespace {

/// What a workpiece of rays shows, or others hand in.
void validate_engagement(const cutting::Engagement& engagement) {
  const std::size_t rings = engagement.slices.size();
  if (rings == 0 && engagement.arcs.empty()) return;  // nothing cuts
  const bool counted = engagement.first_arc.size() == rings + 1 && engagement.first_arc.front() == 0 &&
                       engagement.first_arc.back() == engagement.arcs.size() &&
                       std::ranges::is_sorted(engagement.first_arc);
  if (!counted) {
    throw InvalidInput("engagement.first_arc",
                       "must count the arcs of each ring: one entry more than rings, from 0 up");
  }
  for (const cutting::EdgeSlice& ring : engagement.slices) {
    require_positive("engagement.slices.radius_m", ring.radius_m, "m");
    require_positive("engagement.slices.width_m", ring.width_m, "m");
    require_non_negative("engagement.slices.height_m", ring.height_m, "m");
    if (!(ring.position_rad >= 0.0 && ring.position_rad < std::numbers::pi)) {
      throw InvalidInput("engagement.slices.position_rad", ring.position_rad, "rad", "must lie in [0, 180) degrees");
    }
  }
  for (const cutting::Arc& arc : engagement.arcs) {
    require_finite("engagement.arcs.entry_rad", arc.entry_rad, "rad");
    if (!(arc.exit_rad > arc.entry_rad && arc.exit_rad - arc.entry_rad <= units::revolution * (1.0 + 1e-9))) {
      throw InvalidInput("engagement.arcs.exit_rad", arc.exit_rad, "rad", "must lie within a turn after the entry");
    }
  }
  const Eigen::Matrix3d& turn = engagement.feed_from_tool;
  if (!((turn * turn.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6)) {
    throw InvalidInput("engagement.feed_from_tool", "must be a rotation");
  }
}

}  // namespace

double engaged_height_m(const cutting::Engagement& engagement) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    if (engagement.of(i).empty()) continue;
    const cutting::EdgeSlice& ring = engagement.slices[i];
    const double half = 0.5 * ring.width_m * std::sin(ring.position_rad);
    low = std::min(low, ring.height_m - half);
    high = std::max(high, ring.height_m + half);
  }
  return std::max(high - low, 0.0);
}

void SpatialMilling::validate() const {
  if (engagement) {
    cutter.validate();
    validate_engagement(*engagement);
  } else {
    cut.validate(cutter);
  }
  cutting::require_feed_per_tooth("feed_per_tooth_m", feed_per_tooth_m);
  if (cutter.mill.runout_m > 0.0) {
    require_positive("feed_per_tooth_m", feed_per_tooth_m, "m",
                     "Where there is runout it decides which teeth miss the cut");
  }
  if (coefficients.tangential_n_per_m2.empty()) coefficients.validate(0.0, 0.0);
}

}  // namespace robomill::stability
