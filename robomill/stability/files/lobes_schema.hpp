#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/sweep.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {

/// A chart with what was asked for beside it: lobes.json.
struct LobesView {
  const LobesResult* lobes = nullptr;
  const UncertainLimits* uncertain = nullptr;  ///< null: not asked for
  const SurfaceMap* surface = nullptr;         ///< null: not asked for
};
[[nodiscard]] io::Document<LobesView> lobes_document();

}  // namespace robomill::stability
