#include "robomill/decision/files/result_schema.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_schema.hpp"

namespace robomill::decision {
namespace {

using io::add_rows;
using io::if_positive;
using io::key;
using io::Row;
using io::Schema;
using io::Use;

const Schema<stability::ForcedVibration>& vibration_table() {
  using stability::ForcedVibration;
  static const Schema<ForcedVibration> table(
      "forced_vibration", "the steady vibration of the tip",
      [] {
        std::vector<Row<ForcedVibration>> rows = {
            key("amplitude_um", &ForcedVibration::amplitude_m, "half the peak to peak, where that is greatest"),
            key("harmonic", &ForcedVibration::harmonic, "in which the tip moves most"),
            key(
                "of", [](const ForcedVibration& v) { return v.of_tooth_passing ? "tooth passing" : "rotation"; },
                "what it is a multiple of")
                .words({"tooth passing", "rotation"}),
            key("frequency_hz", &ForcedVibration::frequency_hz, "of that harmonic"),
            key("harmonic_um", &ForcedVibration::harmonic_m, "of that harmonic alone").nullable()};
        add_rows(rows, modal::mode_keys<ForcedVibration>("that moves most in it"));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<Peak>& peak_table() {
  static const Schema<Peak> table(
      "peak", "a peak of the spectrum",
      {key("frequency_hz", &Peak::frequency_hz, "of the peak"), key("amplitude", &Peak::amplitude, "of the peak"),
       key("kind", &Peak::kind, stability::explanation_names, "what it is"), key("text", &Peak::text, "in words")},
      Use::written);
  return table;
}

}  // namespace

const Schema<Recording>& recording_table() {
  static const Schema<Recording> table(
      "recording", "the spectrum of a recorded cut",
      {key("file", &Recording::file, "that was recorded"),
       key("spindle_speed_rpm", &Recording::spindle_speed_rad_per_s, "of the cut"),
       key("teeth", &Recording::teeth, "of the cutter"),
       key(
           "rotation_hz", [](const Recording& r) { return r.spindle_speed_rad_per_s / units::revolution; },
           "of the spindle"),
       key(
           "tooth_passing_hz",
           [](const Recording& r) { return r.spindle_speed_rad_per_s / units::revolution * r.teeth; }, "of the cutter"),
       key("axial_depth_mm", &Recording::axial_depth_m, "of the cut"),
       key(
           "amplitude_unit", [](const Recording&) { return "m/s²"; }, "of all amplitudes"),
       key("frequency_hz", &Recording::frequency_hz, "of the lines, thinned").exact(),
       key("amplitude", &Recording::amplitude, "at each line").exact(),
       key("peaks", &Recording::peaks, peak_table(), "with what they are"),
       key("verdict", &Recording::verdict, verdict_names, "of the spectrum; none: it does not say").nullable(),
       key("reason", &Recording::reason, "of the verdict")},
      Use::written);
  return table;
}

const Schema<ComparedCut>& cut_table() {
  static const Schema<ComparedCut> table(
      "compared_cut", "a test cut beside its prediction",
      {key(
           "spindle_speed_rpm", [](const ComparedCut& cut) { return cut.cut.spindle_speed_rad_per_s; }, "of the cut"),
       key(
           "axial_depth_mm", [](const ComparedCut& cut) { return cut.cut.axial_depth_m; }, "of the cut"),
       key(
           "result", [](const ComparedCut& cut) { return cut.cut.result; }, verdict_names,
           "of the cut; none: not known")
           .nullable(),
       key("predicted", &ComparedCut::predicted, verdict_names, "none: not known").nullable(),
       key("limit_depth_mm", &ComparedCut::limit_depth_m, "predicted at its speed").nullable(),
       key("agrees", &ComparedCut::agrees, "none: nothing to compare").nullable(),
       key("note", &ComparedCut::note, "in words")},
      Use::written);
  return table;
}

const Schema<DepthCurve>& curve_table() {
  static const Schema<DepthCurve> table(
      "depth_curve", "depths that something else than chatter limits",
      {key("label", &DepthCurve::label, "what limits"),
       key("spindle_speed_rpm", &DepthCurve::spindle_speed_rad_per_s, "spindle speeds").exact(),
       key("axial_depth_mm", &DepthCurve::axial_depth_m, "at each").exact()},
      Use::written);
  return table;
}

const Schema<PartLimits>& pair_table() {
  static const Schema<PartLimits> table(
      "part_limits", "limits of a part of the modes",
      {key("label", &PartLimits::label, "which"), key("modes", &PartLimits::modes, "their numbers"),
       key("spindle_speed_rpm", &PartLimits::spindle_speed_rad_per_s, "spindle speeds").exact(),
       key("limit_depth_mm", &PartLimits::limit_depth_m, "at each").nullable()},
      Use::written);
  return table;
}

const Schema<Agreement>& agreement_table() {
  static const Schema<Agreement> table(
      "agreement", "how many test cuts came out as predicted",
      {key("agree", &Agreement::agree, "as predicted"), key("disagree", &Agreement::disagree, "not as predicted"),
       key("not_compared", &Agreement::not_compared, "nothing to compare")},
      Use::written);
  return table;
}

const Schema<LimitShare>& share_table() {
  static const Schema<LimitShare> table("limit_share",
                                        "each mode's share of the speeds at which some mode limits the depth",
                                        {key("tool", &LimitShare::tool, "one a mode").exact(),
                                         key("workpiece", &LimitShare::workpiece, "one a mode").exact()},
                                        Use::written);
  return table;
}

const Schema<FinishLimits>& asked_finish_table() {
  static const Schema<FinishLimits> table(
      "finishing", "what a finishing pass must keep",
      {key(
           "max_surface_error_um", [](const FinishLimits& f) { return if_positive(f.max_surface_error_m); },
           "none: not asked for")
           .nullable(),
       key(
           "max_deflection_um", [](const FinishLimits& f) { return if_positive(f.max_deflection_m); },
           "none: not asked for")
           .nullable()},
      Use::written);
  return table;
}

const Schema<DirectionView>& direction_table() {
  using View = DirectionView;
  static const Schema<View> table(
      "feed_direction", "the limit in one direction of the feed",
      {key(
           "feed_direction_deg", [](const View& v) { return v.directions->direction_rad(v.index); }, "from x"),
       key(
           "lowest_limit_mm", [](const View& v) { return v.directions->lowest_limit_m(v.index); }, "over all speeds")
           .nullable(),
       where([](const View& v) { return v.directions->limit_at_speed_m.size() > 0; },
             key(
                 "limit_at_speed_mm", [](const View& v) { return v.directions->limit_at_speed_m(v.index); },
                 "at the recommended speed")
                 .nullable())},
      Use::written);
  return table;
}

const Schema<Operation>& operation_table() {
  static const Schema<Operation> table(
      "operation", "a speed and a depth to cut at",
      [] {
        std::vector<Row<Operation>> rows = {
            key("spindle_speed_rpm", &Operation::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &Operation::axial_depth_m, "axial depth"),
            key("feed_per_tooth_mm", &Operation::feed_per_tooth_m, "feed per tooth"),
            key("margin", &Operation::margin, "1 - depth / limit"),
            key(
                "cutting_speed_m_per_min", [](const Operation& op) { return op.cutting_speed_m_per_s * units::minute; },
                "of the tooth")
                .in_unit(),
            key(
                "feed_mm_per_min", [](const Operation& op) { return op.feed_m_per_s / units::mm * units::minute; },
                "of the program")
                .in_unit(),
            key("removal_rate_mm3_per_s", &Operation::removal_rate_m3_per_s, "material a second"),
            key(
                "limited_by", [](const Operation& op) { return limited_by_text(op); }, "in words"),
            key("window_limit_mm", &Operation::limit_depth_m, "lowest limit over the speed window").nullable(),
            key(
                "window_chatter_frequency_hz", [](const Operation& op) { return if_positive(op.chatter_frequency_hz); },
                "at that limit; none: nothing chatters")
                .nullable(),
            key("torque_n_m", &Operation::torque_n_m, "mean"),
            key("power_w", &Operation::power_w, "mean"),
            key("surface_error_um", &Operation::surface_error_m, "of the forced vibration; none: not computed")
                .nullable(),
            key("peak_deflection_um", &Operation::peak_deflection_m, "of the forced vibration").nullable(),
            key(
                "forced_vibration",
                [](const Operation& op) { return std::isfinite(op.vibration.amplitude_m) ? &op.vibration : nullptr; },
                vibration_table(), "none: not computed")
                .nullable()};
        add_rows(rows, modal::mode_keys<Operation>("that chatters at the window's limit"));
        return rows;
      }(),
      Use::written);
  return table;
}

}  // namespace robomill::decision
