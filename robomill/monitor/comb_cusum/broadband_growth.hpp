#pragma once
#include <array>
#include <cstddef>

namespace robomill::monitor {

/// Slow chatter of the arm modulates the whole cut, so that what the comb leaves grows in all lines at once. With L and
/// P the medians over five hops of the residual's power and of the whole (a knock is in two), b and c their slowly
/// learnt logs,
///   u = min(ln L - b, ln L/P - c),   S = max(0, S + min(u - 0.7, 0.6)) in hops in which L does not fall:
/// L alone grows with the depth of cut, L/P alone when the tool leaves. Chatter: S > 4 and L > 0.15 P.
class BroadbandGrowth {
 public:
  /// Powers of a hop, > 0. true: it is chatter.
  bool step(double left, double whole) noexcept;
  /// Forgets what was learnt: the speed or the cut has changed.
  void relearn() noexcept { learnt_ = sum_ = 0.0; }
  void reset() noexcept { *this = {}; }

 private:
  static constexpr std::size_t kept = 5;
  std::array<double, kept> left_ = {}, whole_ = {};
  std::size_t hops_ = 0;
  double left_before_ = 0.0, left_base_ = 0.0, share_base_ = 0.0, learnt_ = 0.0, sum_ = 0.0;
};

}  // namespace robomill::monitor
