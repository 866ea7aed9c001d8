#pragma once
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "robomill/jobs/sweep/sensitivity.hpp"

// Method: robomill/jobs/README.md, "Probability (`sweep/probability.hpp`)"

namespace robomill::jobs {

/// What a value is to keep: one of both.
struct Condition {
  std::optional<double> at_least = {}, at_most = {};  ///< in the value's unit

  [[nodiscard]] bool holds(double value) const {
    return (!at_least || value >= *at_least) && (!at_most || value <= *at_most);
  }
};

/// How often samples keep a condition.
struct ConditionShare {
  std::size_t points = 0;    ///< with a value
  std::size_t holding = 0;   ///< of these, those that keep it
  std::size_t infinite = 0;  ///< of these, those whose value is infinite: a limit beyond the depths searched
  std::size_t left_out = 0;  ///< without a value: rejected, or NaN
  Estimate share = {};       ///< holding / points, with Wilson's interval
  /// Of at_least the value that at most the share `worst_share` of the points lies below, of at_most that it lies
  /// above.
  double worst = std::numeric_limits<double>::quiet_NaN();
};

/// holding / points with the score interval of 95 % [Wilson1927] eq. 2: the p with |holding / points - p| <=
/// 1.96 sqrt(p (1 - p) / points). NaN of no points.
[[nodiscard]] Estimate wilson_interval(std::size_t holding, std::size_t points);

/// @param worst_share  0 <= worst_share < 1; below 1 / points the worst value itself
[[nodiscard]] ConditionShare share_of(std::span<const double> values, const Condition& condition, double worst_share);

}  // namespace robomill::jobs
