#pragma once
#include <atomic>
#include <cstddef>

#include "robomill/base/ring.hpp"
#include "robomill/path/blend.hpp"
#include "robomill/path/speed/feed_override.hpp"
#include "robomill/path/speed/segment.hpp"

namespace robomill::path {

struct TimedSegment {
  Segment segment = {};
  double begin_s = 0.0, length_s = 0.0;  ///< of plan time
};

/// Between the thread that plans and the one that moves. A stretch is published after the segments that it covers, and
/// those after their polynomials, so that whoever sees a stretch sees all that it takes to run through it. `closed` is
/// set after the last of all.
struct LookAhead {
  /// whole: the plan ends at rest; broken: it ends where nothing could follow
  enum class Closed { no, whole, broken };
  LookAhead(std::size_t polynomials, std::size_t segments, std::size_t most_stretches)
      : path(polynomials), motion(segments), stretches(most_stretches) {}
  Ring<Polynomial> path;
  Ring<TimedSegment> motion;
  Ring<Stretch> stretches;
  std::atomic<Closed> closed{Closed::no};
};

}  // namespace robomill::path
