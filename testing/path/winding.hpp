#pragma once
// A program without end for benchmarks: short blocks that wind round a cone, the axis leaning to and fro.
#include <cmath>
#include <cstddef>

#include "robomill/program/program.hpp"

namespace robomill::path::test {

class Winding {
 public:
  explicit Winding(double step_rad = 0.01, double feed_m_per_s = 0.05)
      : step_rad_(step_rad), feed_m_per_s_(feed_m_per_s) {}
  [[nodiscard]] static program::Pose pose(double at) {
    const double lean = 0.2 + 0.1 * std::sin(0.37 * at);
    return {.tip_m = {0.06 * std::cos(at), 0.06 * std::sin(at), 0.01 * std::sin(3.0 * at)},
            .axis = {std::sin(lean) * std::cos(at), std::sin(lean) * std::sin(at), std::cos(lean)}};
  }
  [[nodiscard]] static program::Pose start() { return pose(0.0); }
  /// The next block; stays the same until take().
  [[nodiscard]] program::Block block() const {
    const double at = step_rad_ * static_cast<double>(taken_ + 1);
    program::Block out{.kind = program::Block::Kind::feed, .line = taken_ + 1, .end = pose(at)};
    out.duration_s = (out.end.tip_m - pose(at - step_rad_).tip_m).norm() / feed_m_per_s_;
    return out;
  }
  void take() { ++taken_; }
  [[nodiscard]] std::size_t taken() const { return taken_; }

 private:
  double step_rad_, feed_m_per_s_;
  std::size_t taken_ = 0;
};

}  // namespace robomill::path::test
