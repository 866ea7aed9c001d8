#pragma once
#include <span>

#include "robomill/base/cost.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// A chart by its numbers of looks.
struct Looks {
  double a_speed = 0.0;  ///< evaluations at each speed; of the frequency domain, which solves for the limit, limits
  double times = 1.0;    ///< so often: samples of what is not known exactly
  double bytes = 0.0;    ///< that the result holds
  CostDriver counted = {};
};

/// Of looks at these speeds. A valid problem.
[[nodiscard]] Cost cost_of_looks(const LobesProblem& problem, const LobesOptions& options,
                                 std::span<const double> spindle_speeds_rad_per_s, const Looks& looks);

/// Adds points beside a chart, each with its limit or gain margin.
void add_cost_of_points(const LobesProblem& problem, const LobesOptions& options, Cost& cost);

/// Evaluations that a limit between the depths of a column takes.
inline constexpr double looks_a_limit = 40.0;
/// … a node of a map, with the finer run of its estimate.
inline constexpr double looks_a_node = 2.3;

}  // namespace robomill::stability::detail
