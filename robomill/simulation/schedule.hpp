#pragma once
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/simulation/README.md, "The cut"

namespace robomill::simulation {

/// How depth and spindle speed of a cut change with time, as shares of the given ones: straight lines between points,
/// the first and last value before and after them. Two points at one time are a jump.
///
/// The cut at a height that the depth has just reached meets a surface as though earlier teeth had cut it: the force is
/// that of the linear theory at the depth of the moment, without the tooth's way into the flank of the stock.
struct ROBOMILL_API Schedule {
  struct Point {
    double time_s = 0.0;  ///< [s], >= 0, not falling from point to point
    double share = 1.0;
  };
  /// Milling: of the axial depth, from the tip up; drilling: of the radial width. In [0, 1]; empty: 1.
  std::vector<Point> depth = {};
  /// Of the spindle speed, in [0.01, 1]; empty: 1. The feed goes on as fast as at share 1, so that chips grow thicker
  /// when the spindle slows down.
  std::vector<Point> speed = {};

  [[nodiscard]] bool active() const { return !depth.empty() || !speed.empty(); }
  /// Whether nothing changes any more after this time.
  [[nodiscard]] bool constant_after(double time_s) const;
  /// @throws InvalidInput naming the member
  void validate() const;
};

namespace detail {

/// One line of a schedule: its value and its integral from 0.
class Profile {
 public:
  Profile() = default;
  explicit Profile(const std::vector<Schedule::Point>& points);
  [[nodiscard]] bool empty() const { return points_.empty(); }
  [[nodiscard]] double at(double time_s) const;      ///< 1 where there are no points
  [[nodiscard]] double before(double time_s) const;  ///< ∫_0^t [s]

 private:
  std::vector<Schedule::Point> points_;
  std::vector<double> integral_;  ///< up to each point
};

}  // namespace detail
}  // namespace robomill::simulation
