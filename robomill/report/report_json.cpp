#include <algorithm>
#include <utility>

#include "robomill/report/json.hpp"
#include "robomill/report/thin.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_values = 6000;  ///< of a list; more than a plot shows

double value_of(const Json& cell) {
  return cell.is_number() ? cell.get<double>() : missing;
}

/// Rows that hold an extreme of some column, run by run.
Json thinned_rows(Json rows) {
  std::vector<Eigen::VectorXd> columns;
  for (const auto& [key, value] : rows.front().items()) {
    if (!value.is_number()) continue;
    Eigen::VectorXd& column = columns.emplace_back(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) column[static_cast<Eigen::Index>(i)] = value_of(rows[i][key]);
  }
  Json kept = Json::array();
  for (const Eigen::Index i : thin_together(columns, most_values)) {
    kept.push_back(std::move(rows[static_cast<std::size_t>(i)]));
  }
  return kept;
}

/// Lists of so many numbers, null among them.
void collect(Json& node, std::size_t length, std::vector<Json*>& out) {
  if (node.is_object()) {
    for (Json& part : node) collect(part, length, out);
  } else if (node.is_array() && node.size() == length &&
             std::ranges::all_of(node, [](const Json& cell) { return cell.is_number() || cell.is_null(); })) {
    out.push_back(&node);
  }
}

/// Curves over one frequency axis keep the same lines: of each the extremes, run by run.
void thin_curves(Json& json) {
  if (!json.is_object() || !json.contains("frequency_hz") || json["frequency_hz"].size() <= most_values) return;
  std::vector<Json*> lists;
  collect(json, json["frequency_hz"].size(), lists);
  std::vector<Eigen::VectorXd> curves;
  for (const Json* list : lists) {
    Eigen::VectorXd& curve = curves.emplace_back(static_cast<Eigen::Index>(list->size()));
    std::ranges::transform(*list, curve.begin(), value_of);
  }
  const std::vector<Eigen::Index> keep = thin_together(curves, most_values);
  for (Json* list : lists) {
    Json kept = Json::array();
    for (const Eigen::Index i : keep) kept.push_back((*list)[static_cast<std::size_t>(i)]);
    *list = std::move(kept);
  }
}

/// Numbers to six digits, long lists of rows thinned.
Json shown(Json value) {
  if (value.is_number_float()) return number(value.get<double>());
  if (!value.is_structured()) return value;
  if (value.is_array() && value.size() > most_values && value.front().is_object())
    value = thinned_rows(std::move(value));
  for (Json& part : value) part = shown(std::move(part));
  return value;
}

/// What a page needs of a document of another writer.
Json document(const std::string& text) {
  if (text.empty()) return nullptr;
  Json json = Json::parse(text);
  thin_curves(json);
  return shown(std::move(json));
}

}  // namespace

Json shop_units(const Report& report) {
  report.validate();
  Json json = Json::object();
  json["title"] = text(report.title);
  json["created"] = text(report.created);
  json["plan"] = document(report.plan);
  json["frf"] = document(report.frf);
  json["fitted"] = document(report.fitted);
  json["measured"] = document(report.measured);
  json["assembly"] = document(report.assembly);
  json["modes"] = document(report.modes);
  json["workpiece_modes"] = document(report.workpiece_modes);
  json["lobes"] = document(report.lobes);
  json["recordings"] = document(report.recordings);
  json["forces"] = report.forces ? forces_json(*report.forces) : Json(nullptr);
  json["smooth"] = report.smooth ? smooth_json(*report.smooth) : Json(nullptr);
  json["monitor"] = report.monitor ? monitor_json(*report.monitor) : Json(nullptr);
  json["calibration"] = document(report.calibration);
  json["files"] = Json::array();
  for (const StageFile& file : report.files) {
    json["files"].push_back(
        {{"stage", text(file.stage)}, {"file", text(file.file)}, {"description", text(file.description)}});
  }
  return json;
}

std::string report_json(const Report& report) {
  return shop_units(report).dump() + "\n";
}

}  // namespace robomill::report
