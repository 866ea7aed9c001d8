#pragma once
#include "robomill/io/json.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {

/// lobes.json, for a file of its own and for plan.json.
[[nodiscard]] io::Json lobes_object(const LobesResult& result, const UncertainLimits& uncertain = {},
                                    const SurfaceMap& surface = {});

}  // namespace robomill::stability
