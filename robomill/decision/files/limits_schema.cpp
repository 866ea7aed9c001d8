#include "robomill/decision/files/limits_schema.hpp"

#include "robomill/cutting/cut_limits.hpp"

namespace robomill::decision {
namespace {

using io::key;
using io::Schema;

const Schema<SpindleCapacity>& capacity_table() {
  static const Schema<SpindleCapacity> table(
      "capacity", "what the spindle gives at one speed",
      {key("speed_rpm", &SpindleCapacity::spindle_speed_rad_per_s, "spindle speed")
           .as("spindle_speed_rad_per_s")
           .above(0.0)
           .required(),
       key("torque_n_m", &SpindleCapacity::torque_n_m, "greatest there").at_least(0.0).required(),
       key("power_kw", &SpindleCapacity::power_w, "greatest there").at_least(0.0).required()});
  return table;
}

}  // namespace

const Schema<MachineLimits>& spindle_table() {
  static const Schema<MachineLimits> table(
      "spindle", "what the spindle can do",
      {key("min_speed_rpm", &MachineLimits::min_spindle_speed_rad_per_s, "lowest speed; 0: no limit")
           .as("min_spindle_speed_rad_per_s")
           .at_least(0.0),
       key("max_speed_rpm", &MachineLimits::max_spindle_speed_rad_per_s, "highest speed; 0: no limit")
           .as("max_spindle_speed_rad_per_s")
           .at_least(0.0),
       key("curve", &MachineLimits::spindle, capacity_table(),
           "torque and power by rising speed, linear in between; none: no limit")
           .as("spindle")});
  return table;
}

const Schema<MachineLimits>& safety_table() {
  static const Schema<MachineLimits> table(
      "safety", "how far off the limits conditions are kept",
      {key("depth_margin", &MachineLimits::depth_margin, "share of the limit that the depth keeps off …")
           .at_least(0.0)
           .below(1.0, cutting::depth_margin_hint),
       key("speed_window", &MachineLimits::speed_window, "… at every speed within this share of it")
           .at_least(0.0)
           .below(0.5, cutting::speed_window_hint)});
  return table;
}

const Schema<MachineLimits>& edges_table() {
  static const Schema<MachineLimits> table(
      "tool", "the milling cutter",
      {key("max_axial_depth_mm", &MachineLimits::max_axial_depth_m,
           "length of the cutting edges: no recommended depth is larger; 0: no limit")
           .at_least(0.0)});
  return table;
}

const Schema<FinishLimits>& finishing_table() {
  static const Schema<FinishLimits> table(
      "finishing", "a finishing cut: the depth keeps both over the window of speeds; without them they are reported",
      {key("max_surface_error_um", &FinishLimits::max_surface_error_m, "of the surface left; 0: no limit")
           .at_least(0.0),
       key("max_deflection_um", &FinishLimits::max_deflection_m, "of the tip; 0: no limit").at_least(0.0)});
  return table;
}

const Schema<TestCut>& test_cut_table() {
  static const Schema<TestCut> table(
      "cuts", "a test cut that was made",
      {key("spindle_speed_rpm", &TestCut::spindle_speed_rad_per_s, "of the cut").above(0.0).required(),
       key("axial_depth_mm", &TestCut::axial_depth_m, "of the cut").above(0.0).required(),
       key("result", &TestCut::result, decision::verdict_names, "what was observed"),
       key("peaks_hz", &TestCut::peaks_hz, "peaks of its spectrum").above(0.0).or_one(),
       key("file", &TestCut::file, "its recording"),
       key("column", &TestCut::column, "of the recording: name, or number from 1"),
       key("scale", &TestCut::scale, "of WAV: what full scale means in m/s²"),
       key("sample_rate_hz", &TestCut::sample_rate_hz, "of a recording without a column of time").at_least(0.0)});
  return table;
}

}  // namespace robomill::decision
