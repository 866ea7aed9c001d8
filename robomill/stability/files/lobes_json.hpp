#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/stability/compare.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/uncertainty.hpp"

// Method: robomill/stability/README.md, "Files"

namespace robomill::stability {

/// lobes.json as text; with the map, the uncertain limits and the surface where there are some.
[[nodiscard]] ROBOMILL_API std::string lobes_json(const LobesResult& result, const UncertainLimits& uncertain = {},
                                                  const SurfaceMap& surface = {});

/// `robomill lobes --compare` as JSON text.
[[nodiscard]] ROBOMILL_API std::string comparison_json(const MethodComparison& comparison);

}  // namespace robomill::stability
