#include "robomill/cutting/coefficients/moving_mean.hpp"

#include <algorithm>

namespace robomill::cutting::detail {

MovingMean::MovingMean(double window_s)
    : window_s_(window_s), corners_{{.time_s = -window_s, .sum = 0.0}, {.time_s = 0.0, .sum = 0.0}} {}

double MovingMean::add(double value, double duration_s) {
  const Corner last = corners_.back();
  const Corner now = {.time_s = last.time_s + duration_s, .sum = last.sum + value * duration_s};
  corners_.push_back(now);
  const double first_s = now.time_s - window_s_;
  double most = last_;
  // The mean is straight in the window's place but where one of its ends passes a corner.
  const auto mean_from = [&](double begin_s, double sum) {
    last_ = (last.sum + value * (begin_s + window_s_ - last.time_s) - sum) / window_s_;
    most = std::max(most, last_);
  };
  while (corners_[1].time_s <= first_s) {
    corners_.pop_front();
    if (corners_[0].time_s + window_s_ >= last.time_s) mean_from(corners_[0].time_s, corners_[0].sum);
  }
  const Corner& low = corners_[0];
  const Corner& high = corners_[1];
  const double share = high.time_s > low.time_s ? (first_s - low.time_s) / (high.time_s - low.time_s) : 0.0;
  mean_from(first_s, low.sum + share * (high.sum - low.sum));
  return most;
}

}  // namespace robomill::cutting::detail
