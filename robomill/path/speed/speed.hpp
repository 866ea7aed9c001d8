#pragma once
#include <array>
#include <cstddef>
#include <memory>

#include "robomill/path/speed/segment.hpp"

namespace robomill::path {

/// A segment whose speed is sought.
struct SpeedSegment {
  Segment::Kind kind = Segment::Kind::cruise;  ///< not dwell
  double length_m = 0.0;
  std::array<PathPoint, point_count> point = {};
  std::array<double, point_count> share = {first_share, 0.5, last_share};  ///< where the points are
  double safe_b = 0.0;  ///< any b between 0 and this, of this segment and its neighbours, breaks no limit [m²/s²]
  double b = 0.0;       ///< the spline's coefficient: the middle's b. In: feasible. Out: the fastest found
};

struct SpeedOptions {
  double relative_gap = 1e-3;  ///< > 0; of the time above the optimum of the convexified problem, where to stop
  int max_iterations = 80;
};

struct SpeedResult {
  bool feasible = true;  ///< false: b as given breaks a limit, and stays
  bool converged = false;
  int iterations = 0;
  double duration_s = 0.0;
};

/// The fastest b(u) = (du/dt)² on a row of segments: minimises ∫ du / √b over quadratic splines, with every channel's
/// velocity, acceleration and jerk within limits at three points a segment. Acceleration limits are linear in b; the
/// jerk's,
///     |c3 b + 3/2 c2 b' + c1 b''/2| <= J / √b,
/// is taken by the tangent of its right side at each step, which lies below it: an interior-point method whose every
/// iterate obeys every limit, so that stopping early costs time and never a violation. One factorisation of a matrix
/// with five diagonals an iteration; O(segments) time and memory, nothing allocated after construction.
class SpeedSolver {
 public:
  /// @param capacity  most segments in a row
  SpeedSolver(const ChannelLimits& limits, std::size_t capacity);
  ~SpeedSolver();
  SpeedSolver(const SpeedSolver&) = delete;
  SpeedSolver& operator=(const SpeedSolver&) = delete;
  SpeedSolver(SpeedSolver&&) = delete;
  SpeedSolver& operator=(SpeedSolver&&) = delete;

  /// @param segments  first_free, free and others: rows [0, first) and [last, size) keep their b
  SpeedResult solve(SpeedSegment* segments, std::size_t size, std::size_t first, std::size_t last,
                    const SpeedOptions& options) noexcept;

  /// Largest b that SpeedSegment::safe_b may have by the segment's own limits.
  [[nodiscard]] double own_safe_b(const SpeedSegment& segment) const noexcept;
  [[nodiscard]] const ChannelLimits& limits() const noexcept { return limits_; }

 private:
  struct Work;
  struct Direction;
  ChannelLimits limits_;
  std::unique_ptr<Work[]> work_;
};

/// Begin and end b of segment i in a row, from the coefficients: the joints of the spline.
struct SegmentEnds {
  double begin_b, end_b;
};
[[nodiscard]] SegmentEnds ends_of(const SpeedSegment* segments, std::size_t size, std::size_t i) noexcept;

}  // namespace robomill::path
