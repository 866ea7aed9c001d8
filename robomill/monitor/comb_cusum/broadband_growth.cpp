#include "robomill/monitor/comb_cusum/broadband_growth.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double drift = 0.7, most_a_hop = 0.6, alarm_sum = 4.0, least_left_share = 0.15;
constexpr double hops_to_learn = 6.0;                           // that are learnt before any is judged
constexpr double learning_share = 0.05, doubting_share = 0.01;  // share of a hop in the baselines; while it stands high
constexpr double falling_ratio = 0.9, fallen_ratio = 0.7;  // of the median to the last; of the last hop to the median

}  // namespace

bool BroadbandGrowth::step(double left, double whole) noexcept {
  left_[hops_ % kept] = left;
  whole_[hops_ % kept] = whole;
  if (++hops_ < kept) return false;
  const auto median = [](std::array<double, kept> of) {
    std::nth_element(of.begin(), of.begin() + kept / 2, of.end());
    return of[kept / 2];
  };
  const double l = median(left_) + 1e-300;
  const double p = median(whole_) + 1e-300;
  const bool falls = l < falling_ratio * left_before_;
  left_before_ = l;
  const double height = learnt_ > 0.0 ? std::min(std::log(l) - left_base_, std::log(l / p) - share_base_) : 0.0;
  if (learnt_ >= hops_to_learn && !falls) sum_ = std::max(0.0, sum_ + std::min(height - drift, most_a_hop));
  const double usual = learnt_ < hops_to_learn ? 0.0 : height > drift ? doubting_share : learning_share;
  const double share = std::max(usual, 1.0 / (learnt_ + 1.0));
  left_base_ += share * (std::log(l) - left_base_);
  share_base_ += share * (std::log(l / p) - share_base_);
  learnt_ += 1.0;
  return sum_ > alarm_sum && l > least_left_share * p && !falls && left > fallen_ratio * l;
}

}  // namespace robomill::monitor
