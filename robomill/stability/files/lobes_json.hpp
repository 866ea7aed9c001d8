#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/stability/compare.hpp"
#include "robomill/stability/sweep.hpp"

// Method: robomill/stability/README.md, "Files"

namespace robomill::stability {

/// lobes.json of a sweep of another parameter than the axial depth.
[[nodiscard]] ROBOMILL_API std::string sweep_json(const SweepResult& result);

/// `robomill lobes --compare` as JSON text.
[[nodiscard]] ROBOMILL_API std::string comparison_json(const MethodComparison& comparison);

}  // namespace robomill::stability
