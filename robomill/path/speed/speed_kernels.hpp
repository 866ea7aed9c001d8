#pragma once
// The part of SpeedSolver that runs over the channels in lanes.
#include <array>
#include <cstddef>

#include "robomill/base/lanes.hpp"
#include "robomill/path/speed/segment.hpp"

namespace robomill::path {

/// Of a channel: acceleration from above and below, jerk from above and below.
inline constexpr std::size_t sides = 4;
/// What the limits of a point weigh, by side and channel.
struct alignas(8 * lane_count) Duals {
  std::array<Channels, sides> side = {};
  std::array<double, channel_count>& operator[](std::size_t i) { return side[i]; }
  const std::array<double, channel_count>& operator[](std::size_t i) const { return side[i]; }
};

/// b, b' and b'' at a point, or their change.
struct Local {
  double b, first, second;
};

/// A point's constraints in one iteration: in the coordinates (b, b', b'').
struct Assembly {
  const double *c1, *c2, *c3;         // of the channels
  const double *acceleration, *jerk;  // limits
  Duals *z, *dz;
  double acceleration_scale, root_b_inverse_scale;  // limit factors; the jerk's over √b
  Local at;
  double dual_step, mu;
  // Sums over channels: matrix (bb, bf, bs, ff, fs, ss), right side (b, f, s), complementarity.
  double (*sum)[lane_count];
};
/// A point in one step.
struct Stepping {
  const double *c1, *c2, *c3, *acceleration, *jerk;
  const Duals* z;
  Duals* dz;
  double acceleration_scale, root_b_inverse_scale;
  Local at, change;
  double mu;
  double *primal, *dual;  // of the lanes, largest −change / value so far
};

/// Takes the duals' step and sums the point's part of the matrix.
void assemble(Assembly& a);
/// Finds the duals' next step and how far it and the primal one may go.
void step(Stepping& a);
/// Sums over the lanes, in one order whatever vectors the machine has.
void add_lanes(const double (&lanes)[10][lane_count], double (&sum)[10]);

}  // namespace robomill::path
