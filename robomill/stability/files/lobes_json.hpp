#pragma once
#include <string>

#include "robomill/stability/compare.hpp"
#include "robomill/stability/sweep.hpp"

namespace robomill::stability {

/// lobes.json of a sweep of another parameter than the axial depth.
[[nodiscard]] std::string sweep_json(const SweepResult& result);

/// `robomill lobes --compare` as JSON text.
[[nodiscard]] std::string comparison_json(const MethodComparison& comparison);

}  // namespace robomill::stability
