#pragma once
#include <vector>

#include "robomill/path/speed/segment.hpp"

namespace robomill::path {

/// A place on the path in the problem without jerk.
struct BoundPoint {
  double u_m = 0.0;
  Channels c1 = {}, c2 = {};  ///< PathPoint's
  double max_b = 0.0;
  bool rests = false;  ///< the tool stands still here: where a row of points begins and where it ends
};

/// The least time [s] from rest to rest through the points within limits of velocity and acceleration alone, b linear
/// between them: how far b may be at each point so that the next can still be reached, from the end; then as fast as
/// that allows from the beginning. No trajectory on the path that keeps these limits is faster, to the spacing's
/// second order. O(points).
/// Source: [Pham2018].
[[nodiscard]] double least_time_s(const std::vector<BoundPoint>& points, const ChannelLimits& limits);

}  // namespace robomill::path
