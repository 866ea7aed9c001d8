#pragma once
// Seeded five-axis programs for tests of the planner.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/base/random.hpp"
#include "robomill/program/program.hpp"

namespace robomill::path::test {

inline Eigen::Vector3d random_direction(Random& random) {
  const double x = random.normal(), y = random.normal();
  return Eigen::Vector3d(x, y, random.normal()).normalized();
}

/// An axis leaning away from z by at most max_lean_rad.
inline Eigen::Vector3d random_lean(Random& random, double max_lean_rad) {
  const double lean = max_lean_rad * std::sqrt(random.uniform()), round = random.uniform(0.0, 6.283185307179586);
  return {std::sin(lean) * std::cos(round), std::sin(lean) * std::sin(round), std::cos(lean)};
}

/// Corners of any angle, moves of min_m to max_m (evenly in their logarithm), reversals, pure rotations, moves without
/// rotation, tiny moves; all within a sphere of `room_m`, the axis within max_lean_rad of z.
struct RandomProgram {
  int blocks = 100;
  double min_m = 5e-5, max_m = 0.05, room_m = 0.2, max_lean_rad = 0.6, feed_m_per_s = 0.05;
};

inline program::Program random_program(Random& random, const RandomProgram& wish) {
  program::Program out;
  program::Pose at = {.axis = random_lean(random, wish.max_lean_rad)};
  out.start = at;
  program::Pose before = at;
  for (int i = 0; i < wish.blocks; ++i) {
    const double kind = random.uniform();
    double way_m = wish.min_m * std::pow(wish.max_m / wish.min_m, random.uniform());
    program::Pose next = at;
    if (kind < 0.08 && i > 0) {
      next = before;  // a reversal
    } else {
      if (kind < 0.16) way_m *= 0.01;
      if (kind > 0.08 && kind < 0.24) way_m = std::min(way_m, wish.min_m);
      const bool turns = kind < 0.75, moves = kind < 0.24 || kind > 0.32;
      if (moves) {
        next.tip_m += way_m * random_direction(random);
        if (next.tip_m.norm() > wish.room_m) next.tip_m = at.tip_m - way_m * at.tip_m.normalized();
      }
      if (turns) {
        // About as much as the tip moves, at 0.2 rad for 10 mm.
        const double share = std::min(1.0, 20.0 * way_m * random.uniform());
        next.axis = program::between(at, {at.tip_m, random_lean(random, wish.max_lean_rad)}, share).axis.normalized();
      }
    }
    const double u_m = std::max((next.tip_m - at.tip_m).norm(), 0.3 * program::angle_between(next.axis, at.axis));
    if (u_m < 1e-8) continue;
    before = at;
    at = next;
    out.blocks.push_back({.kind = program::Block::Kind::feed,
                          .line = out.blocks.size() + 1,
                          .end = at,
                          .duration_s = std::max(u_m / wish.feed_m_per_s, 1e-6)});
  }
  return out;
}

}  // namespace robomill::path::test
