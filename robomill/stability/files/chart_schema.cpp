#include "robomill/stability/files/chart_schema.hpp"

namespace robomill::stability {
namespace {

using io::key;
using io::Schema;

constexpr const char* not_percent = "It is a share of the value, not a percentage";

/// What a chart of a file may hold.
constexpr Name<Output> outputs[] = {{"boundary", Output::boundary}, {"map", Output::map}};

}  // namespace

const Schema<LobesOptions>& chart_options_table() {
  static const Schema<LobesOptions> table(
      "lobes", "the stability chart",
      {key("spindle_speed_rpm", &LobesOptions::spindle_speed_rad_per_s, "from, to").above(0.0),
       key("axial_depth_mm", &LobesOptions::axial_depth_m, "from, to").at_least(0.0),
       key("grid", &LobesOptions::grid, "speeds and depths at which the chart is evaluated first").at_least(2.0),
       key("method", &LobesOptions::method, method_names, "by which stability is computed"),
       key("output", &LobesOptions::output, outputs, "curves alone, or the spectral radius on the whole grid"),
       key("intervals", &LobesOptions::intervals, "of a tooth period, of the discretizations").at_least(4.0),
       key("tolerance", &LobesOptions::tolerance, "of the spectral radius").at_least(1e-10).at_most(0.1)});
  return table;
}

const Schema<Uncertainty>& uncertainty_options_table() {
  static const Schema<Uncertainty> table(
      "uncertainty", "what is not known exactly: the band of the limit",
      {key("samples", &Uncertainty::samples, "problems drawn").at_least(20.0).at_most(1e6),
       key("grid", &Uncertainty::grid, "speeds and depths").at_least(2.0),
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
