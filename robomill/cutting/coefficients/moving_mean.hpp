#pragma once
#include <deque>

namespace robomill::cutting::detail {

/// The mean over a length of time of something that is constant for a while, then constant again.
class MovingMean {
 public:
  /// @param window_s  > 0. Before the beginning there was nothing: 0.
  explicit MovingMean(double window_s);
  /// Goes on with a value for a time >= 0.
  /// @return the largest mean over the window, of all windows that end then or at its beginning
  double add(double value, double duration_s);

 private:
  struct Corner {
    double time_s = 0.0, sum = 0.0;  ///< of value times time up to then
  };
  double window_s_;
  double last_ = 0.0;           ///< mean over the latest window
  std::deque<Corner> corners_;  ///< the first at the latest window's beginning or before it
};

}  // namespace robomill::cutting::detail
