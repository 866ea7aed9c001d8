#include "robomill/jobs/files/plan_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/modal/files/modal_objects.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/page/thin.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/process/files/blocks_json.hpp"
#include "robomill/process/files/decision_json.hpp"
#include "robomill/process/files/forces_json.hpp"
#include "robomill/stability/files/lobes_object.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::number;

Json text_or_null(std::string_view text) {
  return text.empty() ? Json() : Json(text);
}

Json cuts_json(const PlanResult& result) {
  Json rows = Json::array();
  for (const decision::ComparedCut& cut : result.cuts) {
    rows.push_back({{"spindle_speed_rpm", number(cut.cut.spindle_speed_rad_per_s / units::rpm)},
                    {"axial_depth_mm", number(cut.cut.axial_depth_m / units::mm)},
                    {"result", text_or_null(to_string(cut.cut.result))},
                    {"predicted", text_or_null(to_string(cut.predicted))},
                    {"limit_depth_mm", number(cut.limit_depth_m / units::mm)},
                    {"agrees", cut.agrees ? Json(*cut.agrees) : Json()},
                    {"note", cut.note}});
  }
  return rows;
}

Json feed_directions_json(const decision::FeedDirections& directions) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < directions.direction_rad.size(); ++i) {
    Json row = {{"feed_direction_deg", number(directions.direction_rad(i) / units::deg)},
                {"lowest_limit_mm", number(directions.lowest_limit_m(i) / units::mm)}};
    if (directions.limit_at_speed_m.size() > 0)
      row["limit_at_speed_mm"] = number(directions.limit_at_speed_m(i) / units::mm);
    rows.push_back(std::move(row));
  }
  return rows;
}

Json facts_json(const PlanResult& result) {
  const cutting::Milling& cut = result.cut.problem.milling;
  const auto fact = [](const char* label, std::string value) -> Json {
    return {{"label", label}, {"value", std::move(value)}};
  };
  return Json::array(
      {fact("Cutter", fmt::format("{} teeth, {:.4g} mm, helix {:.3g}°", cut.tool.teeth, cut.tool.diameter_m / units::mm,
                                  cut.tool.helix_rad / units::deg)),
       fact("Cut", fmt::format("radial depth {:.4g} mm, teeth in cut from {:.1f}° to {:.1f}°, {:.4g} mm a tooth",
                               result.cut.radial_depth_m / units::mm, cut.immersion.entry_rad / units::deg,
                               cut.immersion.exit_rad / units::deg, cut.feed_per_tooth_m / units::mm)),
       fact("Material", fmt::format("tangential {:.4g} N/mm², radial {:.4g} N/mm²",
                                    cut.coefficients.tangential_n_per_m2 / units::n_per_mm2,
                                    cut.coefficients.radial_n_per_m2 / units::n_per_mm2)),
       fact("Feed direction", fmt::format("{:.4g}° from x", result.cut.problem.feed_direction_rad / units::deg))});
}

/// NaN is null.
Json depths_json(const Eigen::VectorXd& depths_m) {
  Json list = Json::array();
  for (const double depth_m : depths_m) list.push_back(number(depth_m / units::mm));
  return list;
}

Json other_limits_json(const PlanResult& result) {
  Json list = Json::array();
  if (!result.recommends()) return list;
  for (const decision::DepthCurve& curve :
       decision::other_limits(result.cut.problem.milling, result.job.recommend, result.cut.options)) {
    list.push_back({{"label", curve.label},
                    {"spindle_speed_rpm", io::numbers(curve.spindle_speed_rad_per_s / units::rpm)},
                    {"axial_depth_mm", io::numbers(curve.axial_depth_m / units::mm)}});
  }
  return list;
}

Json pairs_json(const PlanResult& result) {
  Json list = Json::array();
  for (const decision::PartLimits& part : result.pairs) {
    list.push_back({{"label", part.label},
                    {"modes", part.modes},
                    {"spindle_speed_rpm", io::numbers(part.spindle_speed_rad_per_s / units::rpm)},
                    {"limit_depth_mm", depths_json(part.limit_depth_m)}});
  }
  return list;
}

Json vibration_json(const stability::ForcedVibration& v) {
  if (!std::isfinite(v.amplitude_m)) return {};
  Json json = {{"amplitude_um", number(v.amplitude_m / units::um)},
               {"harmonic", v.harmonic},
               {"of", v.of_tooth_passing ? "tooth passing" : "rotation"},
               {"frequency_hz", number(v.frequency_hz)},
               {"harmonic_um", number(v.harmonic_m / units::um)}};
  modal::set_mode(json, v.mode);
  return json;
}

}  // namespace

Json operation_json(const decision::Operation& op) {
  Json json = {
      {"spindle_speed_rpm", number(op.spindle_speed_rad_per_s / units::rpm)},
      {"axial_depth_mm", number(op.axial_depth_m / units::mm)},
      {"feed_per_tooth_mm", number(op.feed_per_tooth_m / units::mm)},
      {"margin", number(op.margin)},
      {"cutting_speed_m_per_min", number(op.cutting_speed_m_per_s * units::minute)},
      {"feed_mm_per_min", number(op.feed_m_per_s / units::mm * units::minute)},
      {"removal_rate_mm3_per_s", number(op.removal_rate_m3_per_s / units::mm3)},
      {"limited_by", decision::limited_by_text(op)},
      {"window_limit_mm", number(op.limit_depth_m / units::mm)},
      {"window_chatter_frequency_hz", op.chatter_frequency_hz > 0.0 ? number(op.chatter_frequency_hz) : Json()},
      {"torque_n_m", number(op.torque_n_m)},
      {"power_w", number(op.power_w)},
      {"surface_error_um", number(op.surface_error_m / units::um)},
      {"peak_deflection_um", number(op.peak_deflection_m / units::um)},
      {"forced_vibration", vibration_json(op.vibration)}};
  modal::set_mode(json, op.mode);
  return json;
}

Json decision_json(const PlanResult& result) {
  const auto limit = [](double value_m) { return value_m > 0.0 ? number(value_m / units::um) : Json(); };
  Json json;
  const decision::Agreement count = decision::agreement(result.cuts);
  if (result.recommends()) json["facts"] = facts_json(result);
  json["agreement"] = {{"agree", count.agree}, {"disagree", count.disagree}, {"not_compared", count.not_compared}};
  json["recommended"] = result.recommendation.recommended ? operation_json(*result.recommendation.recommended) : Json();
  json["alternatives"] = Json::array();
  for (const decision::Operation& op : result.recommendation.alternatives)
    json["alternatives"].push_back(operation_json(op));
  if (!result.recommendation.recommended) json["reason"] = result.recommendation.reason;
  json["finishing"] = {{"max_surface_error_um", limit(result.job.finish.max_surface_error_m)},
                       {"max_deflection_um", limit(result.job.finish.max_deflection_m)}};
  json["other_limits"] = other_limits_json(result);
  json["pairs"] = pairs_json(result);
  const decision::LimitShare share =
      decision::limit_share(result.lobes.limit, result.model, result.cut.problem.workpiece_dynamics);
  json["limit_share"] = {{"tool", io::numbers(share.tool)}, {"workpiece", io::numbers(share.workpiece)}};
  json["cuts"] = cuts_json(result);
  if (result.feed_directions) {
    json["feed_direction_deg"] = number(result.cut.problem.feed_direction_rad / units::deg);
    json["feed_directions"] = feed_directions_json(*result.feed_directions);
  }
  if (result.hits) json["hit_directions"] = result.hit_directions;
  if (result.decision) {
    process::DecisionOutput output{.collisions_checked = collisions_checked(result)};
    if (result.decided && result.decided->text) output.changed_lines = result.decided->text->changed_lines;
    json["decision"] = process::decision_object(*result.decision, *result.shown().forces, result.job.decide, output);
  }
  json["warnings"] = result.warnings;
  json["notes"] = result.notes;
  return json;
}

Json recordings_json(const PlanResult& result) {
  Json list = Json::array();
  for (const decision::Recording& recording : result.recordings) {
    Json peaks = Json::array();
    for (const decision::Peak& peak : recording.peaks) {
      peaks.push_back({{"frequency_hz", number(peak.frequency_hz)},
                       {"amplitude", number(peak.amplitude)},
                       {"kind", to_string(peak.kind)},
                       {"text", peak.text}});
    }
    // A long recording's spectrum is thinned before it is text, by the page's own rule.
    const std::vector<Eigen::Index> keep = page::thin(recording.amplitude);
    const double rotation_hz = recording.spindle_speed_rad_per_s / (2.0 * std::numbers::pi);
    list.push_back({{"file", recording.file},
                    {"spindle_speed_rpm", number(recording.spindle_speed_rad_per_s / units::rpm)},
                    {"teeth", recording.teeth},
                    {"rotation_hz", number(rotation_hz)},
                    {"tooth_passing_hz", number(rotation_hz * recording.teeth)},
                    {"axial_depth_mm", number(recording.axial_depth_m / units::mm)},
                    {"amplitude_unit", "m/s²"},
                    {"frequency_hz", io::numbers(recording.frequency_hz(keep))},
                    {"amplitude", io::numbers(recording.amplitude(keep))},
                    {"peaks", std::move(peaks)},
                    {"verdict", text_or_null(to_string(recording.verdict))},
                    {"reason", recording.reason}});
  }
  return list;
}

Json plan_object(const PlanResult& result) {
  Json json = decision_json(result);
  json["assumed"] = io::assumed_json(result.assumed);
  if (result.prediction) json["assembly"] = prediction_object(*result.prediction);
  if (result.hits) json["frf"] = modal::hits_object(*result.hits);
  if (result.job.has_structure())
    json["modes"] = result.fit ? modal::modes_object(*result.fit) : modal::modes_object(result.model);
  if (result.has_lobes()) json["lobes"] = stability::lobes_object(result.lobes, result.uncertain);
  const PlannedProgram& shown = result.shown();
  if (shown.forces) json["forces"] = process::forces_object(*shown.forces);
  if (shown.blocks) json["blocks"] = process::blocks_summary(*shown.forces, *shown.blocks);
  if (shown.path) json["path"] = path::smooth_object(shown.path->smoothed);
  return json;
}

std::string plan_text(const Json& plan) {
  return plan.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_json(const PlanResult& result) {
  return plan_text(plan_object(result));
}

}  // namespace robomill::jobs
