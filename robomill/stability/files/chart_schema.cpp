#include "robomill/stability/files/chart_schema.hpp"

namespace robomill::stability {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::of;
using io::Schema;

constexpr const char* not_percent = "It is a share of the value, not a percentage";

/// What a chart of a file may hold.
constexpr Name<Output> outputs[] = {{"boundary", Output::boundary}, {"map", Output::map}};

}  // namespace

std::string swept_key(SweptParameter parameter) {
  return std::string(name_in(swept_names, parameter)) + (is_angle(parameter) ? "_deg" : "_mm");
}

std::optional<std::array<double, 2>> ChartTable::range_of(SweptParameter parameter) const {
  if (parameter == SweptParameter::radial_depth) return radial_depth_m;
  if (parameter == SweptParameter::lead) return lead_rad;
  if (parameter == SweptParameter::tilt) return tilt_rad;
  return std::nullopt;
}

const Schema<ChartTable>& chart_options_table() {
  const auto option = [](const io::Row<LobesOptions>& row) { return of(&ChartTable::options, row); };
  const auto range = [](SweptParameter parameter, std::optional<std::array<double, 2>> ChartTable::*member) {
    return key(swept_key(parameter), member, "from, to, where sweep varies it").as("range");
  };
  static const Schema<ChartTable> table(
      "lobes", "the stability chart",
      {option(key("spindle_speed_rpm", &LobesOptions::spindle_speed_rad_per_s, "from, to").above(0.0).entries(2)),
       option(key(swept_key(SweptParameter::axial_depth), &LobesOptions::axial_depth_m, "from, to")
                  .at_least(0.0)
                  .entries(2)
                  .no_default()),
       key("sweep", &ChartTable::sweep, swept_names, "what the chart varies beside the speed (grid then 60 x 40)"),
       range(SweptParameter::radial_depth, &ChartTable::radial_depth_m),
       range(SweptParameter::lead, &ChartTable::lead_rad), range(SweptParameter::tilt, &ChartTable::tilt_rad),
       option(key("grid", &LobesOptions::grid,
                  "speeds and depths at which the chart is evaluated first; of a sweep 60 and 40")
                  .at_least(2.0)
                  .at_most(20000.0)
                  .entries(2)),
       option(key("method", &LobesOptions::method, method_names,
                  "by which stability is computed; zeroth-order and multi-frequency give limits, no map")),
       option(key("output", &LobesOptions::output, outputs, "curves alone, or the spectral radius on the whole grid")),
       option(key("intervals", &LobesOptions::intervals, "of a tooth period, of the discretizations").at_least(4.0)),
       option(key("tolerance", &LobesOptions::tolerance, "of the spectral radius").at_least(1e-10).at_most(0.1))});
  return table;
}

const Schema<SurfaceErrorTable>& surface_error_table() {
  static const Schema<SurfaceErrorTable> table(
      "surface_error", "requests the map of surface errors, for charts over the axial depth; needs the feed",
      {key("grid", &SurfaceErrorTable::grid, "speeds and depths").at_least(2.0).entries(2)});
  return table;
}

const Schema<Uncertainty>& uncertainty_options_table() {
  static const Schema<Uncertainty> table(
      "uncertainty", "what is not known exactly: the band of the limit",
      {key("samples", &Uncertainty::samples, "problems drawn, 200 unless given").at_least(20.0).at_most(1e6),
       key("grid", &Uncertainty::grid, "speeds and depths").at_least(2.0).at_most(20000.0).entries(2),
       key("tangential_std_n_per_mm2", &Uncertainty::tangential_std_n_per_m2, "standard deviation of Kt").at_least(0.0),
       key("radial_std_n_per_mm2", &Uncertainty::radial_std_n_per_m2, "standard deviation of Kr").at_least(0.0),
       key("coefficient_std_ratio", &Uncertainty::coefficient_std_ratio, "of one factor on all cutting coefficients")
           .at_least(0.0)
           .at_most(1.0, not_percent),
       key("frequency_std_ratio", &Uncertainty::frequency_std_ratio,
           "of frequencies of modes that do not state their own")
           .at_least(0.0)
           .at_most(0.5, not_percent),
       key("damping_std_ratio", &Uncertainty::damping_std_ratio,
           "of damping ratios of modes that do not state their own")
           .at_least(0.0)
           .at_most(1.0, not_percent),
       key("residue_std_ratio", &Uncertainty::residue_std_ratio, "of residues of modes that do not state their own")
           .at_least(0.0)
           .at_most(1.0, not_percent)});
  return table;
}

}  // namespace robomill::stability
