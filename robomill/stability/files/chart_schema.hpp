#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {

/// [lobes] of a chart over the axial depth.
[[nodiscard]] const io::Schema<LobesOptions>& chart_options_table();
/// [uncertainty]
[[nodiscard]] const io::Schema<Uncertainty>& uncertainty_options_table();

}  // namespace robomill::stability
