#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/workpiece.hpp"

/// Where a ring of the cutter stands in material.
namespace robomill::cutting::detail {

/// A pose with directions across its axis.
struct Stand {
  Eigen::Vector3d tip, x, y, z;
  Eigen::Vector3d velocity, turn;
  /// At most that of a ring's points.
  [[nodiscard]] double speed(const EdgeSlice& slice) const {
    return velocity.norm() + turn.norm() * (slice.radius_m + slice.height_m);
  }
};

/// What a look at one ring gave.
struct Seen {
  double depth_m = 0.0;  ///< greatest in material on the ring's front; < 0: all of it is in air
  std::vector<Arc> arcs = {};
};

/// Looks at rings of one pose: front by normals and velocities, then material on it.
struct RingLook {
  const Stand& stand;
  const Workpiece& part;
  double ahead_m = 0.0;  ///< points are looked at that much further along their velocity
  double close_m = 0.0;  ///< how well the ends of arcs are found
  /// @param angle_step_rad  between first looks around the ring
  void at(const EdgeSlice& slice, double angle_step_rad, Seen& seen) const;
};

/// Brings an arc's entry into [0, 2π).
[[nodiscard]] Arc normalised(double entry_rad, double exit_rad);

/// Where f changes sign between two places of unlike sign, to within `close`, or where its magnitude falls below
/// `enough`: regula falsi, Illinois.
template <class F>
double crossing(F&& f, double a, double f_a, double b, double f_b, double close, double enough = 0.0) {
  double weight_a = f_a;
  double weight_b = f_b;
  for (int i = 0; i < 40 && b - a > close; ++i) {
    const double share = std::clamp(weight_a / (weight_a - weight_b), 0.1, 0.9);
    const double middle = a + share * (b - a);
    const double at = f(middle);
    if (std::abs(at) < enough) return middle;
    if ((at > 0.0) == (f_a > 0.0)) {  // Illinois: a side that stays is halved
      a = middle;
      weight_a = at;
      weight_b *= 0.5;
    } else {
      b = middle;
      weight_b = at;
      weight_a *= 0.5;
    }
  }
  return 0.5 * (a + b);
}

}  // namespace robomill::cutting::detail
