#include <nlohmann/json.hpp>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/files/forces_json.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/stability/files/lobes_json.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::number;

Json to_json(const decision::Operation& op) {
  Json json = {{"spindle_speed_rpm", number(op.spindle_speed_rad_per_s / units::rpm)},
               {"axial_depth_mm", number(op.axial_depth_m / units::mm)},
               {"feed_per_tooth_mm", number(op.feed_per_tooth_m / units::mm)},
               {"margin", number(op.margin)},
               {"cutting_speed_m_per_min", number(op.cutting_speed_m_per_s * units::minute)},
               {"feed_mm_per_min", number(op.feed_m_per_s / units::mm * units::minute)},
               {"removal_rate_mm3_per_s", number(op.removal_rate_m3_per_s / units::mm3)},
               {"limited_by", limited_by_text(op)},
               {"limit_depth_mm", number(op.limit_depth_m / units::mm)},
               {"chatter_frequency_hz", op.chatter_frequency_hz > 0.0 ? number(op.chatter_frequency_hz) : Json()},
               {"torque_n_m", number(op.torque_n_m)},
               {"power_w", number(op.power_w)},
               {"surface_error_um", number(op.surface_error_m / units::um)},
               {"peak_deflection_um", number(op.peak_deflection_m / units::um)}};
  modal::set_mode(json, op.mode);
  return json;
}

const char* to_text(report::Verdict verdict) {
  switch (verdict) {
    case report::Verdict::stable:
      return "stable";
    case report::Verdict::borderline:
      return "borderline";
    case report::Verdict::chatter:
      return "chatter";
    case report::Verdict::unknown:
      break;
  }
  return nullptr;
}

Json text_or_null(const char* text) {
  return text == nullptr ? Json() : Json(text);
}

Json cuts_json(const PlanResult& result) {
  Json rows = Json::array();
  for (const report::TestCut& cut : result.cuts) {
    rows.push_back({{"spindle_speed_rpm", number(cut.spindle_speed_rad_per_s / units::rpm)},
                    {"axial_depth_mm", number(cut.axial_depth_m / units::mm)},
                    {"result", text_or_null(to_text(cut.result))},
                    {"predicted", text_or_null(to_text(cut.predicted))},
                    {"limit_depth_mm", number(cut.limit_depth_m / units::mm)},
                    {"agrees", cut.agrees ? Json(*cut.agrees) : Json()},
                    {"note", cut.note}});
  }
  return rows;
}

Json feed_directions_json(const report::FeedDirections& directions) {
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

std::string modes_json(const PlanResult& result) {
  return result.fit ? modal::modes_json(*result.fit) : modal::modes_json(result.model);
}

std::string lobes_json(const PlanResult& result) {
  return stability::lobes_json(result.lobes, result.uncertain);
}

/// What an earlier run computed from modes that this one has not.
void remove_later_stages(const std::filesystem::path& folder) {
  for (const char* name : {"lobes.json", "smooth.json", "trajectory.csv"}) io::remove_file(folder / name);
}

}  // namespace

std::string plan_json(const PlanResult& result) {
  Json json;
  const report::Agreement count = report::agreement(result.cuts);
  json["agreement"] = {{"agree", count.agree}, {"disagree", count.disagree}, {"not_compared", count.not_compared}};
  json["recommended"] = result.recommendation.recommended ? to_json(*result.recommendation.recommended) : Json();
  json["alternatives"] = Json::array();
  for (const decision::Operation& op : result.recommendation.alternatives) json["alternatives"].push_back(to_json(op));
  if (!result.recommendation.recommended) json["reason"] = result.recommendation.reason;
  json["cuts"] = cuts_json(result);
  if (result.feed_directions) json["feed_directions"] = feed_directions_json(*result.feed_directions);
  json["warnings"] = result.warnings;
  json["notes"] = result.notes;
  if (result.prediction) json["assembly"] = Json::parse(prediction_json(*result.prediction));
  if (result.hits) json["frf"] = Json::parse(modal::hits_json(*result.hits));
  json["modes"] = Json::parse(modes_json(result));
  if (result.has_lobes()) json["lobes"] = Json::parse(lobes_json(result));
  if (result.forces) json["forces"] = forces_object(*result.forces);
  if (result.path) json["path"] = Json::parse(path::smooth_json(result.path->smoothed));
  return json.dump(1) + "\n";
}

void write_plan(const std::filesystem::path& folder, const PlanResult& result) {
  io::make_folder(folder);
  std::vector<report::StageFile> files;
  if (result.frfs) {
    modal::write_frfs(folder / "tip.uff", *result.frfs);
    files.push_back(
        {.stage = "frf",
         .file = "tip.uff",
         .description = result.prediction ? "predicted FRFs, universal file 58" : "measured FRFs, universal file 58"});
  }
  io::write_file(folder / "modes.json", modes_json(result));
  files.push_back({.stage = "modes", .file = "modes.json", .description = "modal parameters"});
  if (result.has_lobes()) {
    io::write_file(folder / "lobes.json", lobes_json(result));
    files.push_back({.stage = "lobes", .file = "lobes.json", .description = "stability lobes"});
  } else {
    remove_later_stages(folder);
  }
  if (result.forces) {
    io::write_file(folder / "forces.csv", forces_csv(*result.forces));
    files.push_back({.stage = "forces",
                     .file = "forces.csv",
                     .description = result.forces->program ? "cutting forces, a row a block of the program"
                                                           : "cutting forces over a revolution"});
  }
  if (result.path) {
    files.push_back({.stage = "path", .file = "smooth.json", .description = "the smoothed program beside its limits"});
    if (result.path->smoothed.written) {
      files.push_back({.stage = "path",
                       .file = result.path->output.filename().string(),
                       .description = "joints and tool, a row a sample"});
    }
  }
  files.push_back({.stage = "plan", .file = "plan.json", .description = "recommendation and every stage's result"});
  const std::string page = report::report_html(make_report(result, files));
  if (result.path) {
    place(*result.path);
    io::write_file(folder / "smooth.json", path::smooth_json(result.path->smoothed));
  }
  io::write_file(folder / "plan.json", plan_json(result));
  io::write_file(folder / "report.html", page);
}

}  // namespace robomill::jobs
