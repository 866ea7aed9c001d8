#pragma once
// How far two blocks may overlap at their corner; docs/theory/fir-smoothing.md.
#include <Eigen/Core>

#include "robomill/path/published/fir_profile.hpp"

namespace robomill::path {

/// The change of velocity at a corner, V² = v² + v'² − 2 v v' cos θ; as printed without the 2.
[[nodiscard]] double corner_speed(const Eigen::Vector3d& velocity, const Eigen::Vector3d& next_velocity,
                                  bool as_printed);

/// Where a great circle ends, the direction in which it does, times its angle: of the arc from one unit vector to
/// another; zero where both are the same.
[[nodiscard]] Eigen::Vector3d end_tangent(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Distance of the corner from the path where two blocks overlap by T_c behind the same filters: V tail(T_c/2). For
/// blocks behind different filters it is an upper bound with the shorter ones.
[[nodiscard]] double corner_error(const Boxes& filters, double speed, double overlap_s);

/// The largest T_c, at most the filters' sum, at which the corner's error is within a tolerance; pulses stand first in
/// the boxes.
[[nodiscard]] double largest_overlap_s_of(const Boxes& block, const Boxes& next, double speed, double tolerance);

}  // namespace robomill::path
