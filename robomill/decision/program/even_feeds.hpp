#pragma once
#include <vector>

namespace robomill::decision {

/// Feeds that cuts on end may have.
struct FeedBounds {
  double length_m = 0.0;
  double least_m_per_s = 0.0, most_m_per_s = 0.0;
};

/// One feed a cut with few changes: of all that take at most (1 + slack) times as long as the greatest feeds, those of
/// the least time + p · changes, with the greatest p of twenty halvings. Feeds are whole multiples of step_m_per_s
/// where one lies within the bounds; 0: any.
[[nodiscard]] std::vector<double> even_feeds(const std::vector<FeedBounds>& cuts, double slack, double step_m_per_s);

}  // namespace robomill::decision
