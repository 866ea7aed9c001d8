#pragma once
#include "robomill/base/progress.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

[[nodiscard]] constexpr bool in_frequency_domain(Method method) {
  return method == Method::zeroth_order || method == Method::multi_frequency;
}

/// Limits, boundary and points of a chart by a frequency-domain method.
/// @throws InvalidInput if the options ask for a map, or measured FRFs do not cover what matters
LobesResult frequency_lobes(const LobesProblem& problem, const LobesOptions& options, Progress& progress);
std::vector<Limit> frequency_limits(const LobesProblem& problem, const LobesOptions& options,
                                    const std::vector<double>& spindle_speeds_rad_per_s, Progress& progress);
PointResult frequency_point(const LobesProblem& problem, const LobesOptions& options, const OperatingPoint& point);

}  // namespace robomill::stability::detail
