#pragma once
#include <optional>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/stability/compare.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/sweep.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {

/// A chart with what was asked for beside it.
struct LobesView {
  LobesView() = default;
  LobesView(const LobesResult& result, const UncertainLimits& limits, const SurfaceMap& map)
      : lobes(&result),
        uncertain(limits.samples > 0 ? &limits : nullptr),
        surface(map.axial_depth_m.size() > 0 ? &map : nullptr) {}
  const LobesResult* lobes = nullptr;
  const UncertainLimits* uncertain = nullptr;  ///< null: not asked for
  const SurfaceMap* surface = nullptr;         ///< null: not asked for
};
/// lobes.json
[[nodiscard]] const io::Schema<LobesView>& lobes_table();
[[nodiscard]] io::Json lobes_object(const LobesResult& result, const UncertainLimits& uncertain = {},
                                    const SurfaceMap& surface = {});
/// lobes.json of a sweep of another parameter than the axial depth.
[[nodiscard]] const io::Schema<SweepResult>& sweep_table();
/// The depths of limits; none where no depth is unstable.
[[nodiscard]] std::vector<std::optional<double>> limit_depths_of(const std::vector<Limit>& limits);
/// `robomill lobes --compare`
[[nodiscard]] const io::Schema<MethodComparison>& comparison_table();

}  // namespace robomill::stability
