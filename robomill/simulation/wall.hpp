#pragma once
#include <vector>

#include "robomill/simulation/engine.hpp"

namespace robomill::simulation::detail {

/// The finished wall over the feed at one height.
struct WallLine {
  std::vector<double> out_m;  ///< evenly spaced along x; beyond the commanded wall
};

/// The farthest that any pass reached at each place, 64 places a mean tooth feed, away from both ends.
/// @param passes  of one ring, in the order made
[[nodiscard]] WallLine wall_line(const std::vector<WallPass>& passes, double feed_per_tooth_m);

struct Roughness {
  double mean_m = 0.0;  ///< of the line
  double ra_m = 0.0;    ///< mean distance from it
  double rz_m = 0.0;    ///< highest to lowest
};
[[nodiscard]] Roughness roughness(const WallLine& line);

}  // namespace robomill::simulation::detail
