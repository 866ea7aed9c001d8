#pragma once
#include <array>
#include <optional>
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/spatial.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {

/// The key of what a chart varies: "axial_depth_mm", "lead_deg".
[[nodiscard]] std::string swept_key(SweptParameter parameter);

/// [lobes]: a chart, and over which range it varies what.
struct ChartTable {
  LobesOptions options = {};
  SweptParameter sweep = SweptParameter::axial_depth;
  std::optional<std::array<double, 2>> radial_depth_m = {}, lead_rad = {}, tilt_rad = {};
  /// Of another parameter than the axial depth.
  [[nodiscard]] std::optional<std::array<double, 2>> range_of(SweptParameter parameter) const;
};
[[nodiscard]] const io::Schema<ChartTable>& chart_options_table();
/// [uncertainty]
[[nodiscard]] const io::Schema<Uncertainty>& uncertainty_options_table();

/// [surface_error]: a map of it beside the chart.
struct SurfaceErrorTable {
  std::array<int, 2> grid = {60, 60};
};
[[nodiscard]] const io::Schema<SurfaceErrorTable>& surface_error_table();

}  // namespace robomill::stability
