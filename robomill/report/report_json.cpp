#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/report/json.hpp"
#include "robomill/report/thin.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_rows = 6000;    ///< of a list
constexpr std::size_t most_lines = 12000;  ///< of an axis that all FRFs of a document share

double value_of(const Json& row, const std::string& key) {
  const auto cell = row.find(key);
  return cell != row.end() && cell->is_number() ? cell->get<double>() : missing;
}

/// Rows that hold an extreme of some column, run by run.
Json thinned_rows(Json rows) {
  std::set<std::string> keys;
  for (const Json& row : rows) {
    for (const auto& [key, value] : row.items()) {
      if (value.is_number()) keys.insert(key);
    }
  }
  std::vector<Eigen::VectorXd> columns;
  for (const std::string& key : keys) {
    Eigen::VectorXd& column = columns.emplace_back(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) column[static_cast<Eigen::Index>(i)] = value_of(rows[i], key);
  }
  Json kept = Json::array();
  for (const Eigen::Index i : thin_together(columns, most_rows)) {
    kept.push_back(std::move(rows[static_cast<std::size_t>(i)]));
  }
  return kept;
}

/// Lists of so many values.
void collect(Json& node, std::size_t length, std::vector<Json*>& out) {
  if (node.is_object()) {
    for (Json& part : node) collect(part, length, out);
  } else if (node.is_array() && node.size() == length && !node.front().is_structured()) {
    out.push_back(&node);
  }
}

/// The lines at which some |H| has an extreme, run by run; everything over their axis keeps the same ones.
void thin_frfs(Json& json) {
  if (!json.is_object() || !json.contains("receptance_m_per_n")) return;
  json.erase("deviation_m_per_n");  // no page draws it
  const std::size_t lines = json["frequency_hz"].size();
  if (lines <= most_lines) return;
  std::vector<Eigen::VectorXd> magnitudes;
  for (const Json& frf : json["receptance_m_per_n"]) {
    Eigen::VectorXd& magnitude = magnitudes.emplace_back(static_cast<Eigen::Index>(lines));
    for (std::size_t i = 0; i < lines; ++i) {
      const Json& re = frf["re"][i];
      const Json& im = frf["im"][i];
      const bool known = re.is_number() && im.is_number();
      magnitude[static_cast<Eigen::Index>(i)] = known ? std::hypot(re.get<double>(), im.get<double>()) : missing;
    }
  }
  const std::vector<Eigen::Index> keep = thin_together(magnitudes, most_lines);
  std::vector<Json*> lists;
  collect(json, lines, lists);
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
  if (value.is_array() && value.size() > most_rows && value.front().is_object()) value = thinned_rows(std::move(value));
  for (Json& part : value) part = shown(std::move(part));
  return value;
}

/// What a page needs of a document of another writer.
Json document(const std::string& text) {
  if (text.empty()) return nullptr;
  Json json = Json::parse(text);
  thin_frfs(json);
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
  json["smooth"] = document(report.smooth);
  json["motion"] = document(report.motion);
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
