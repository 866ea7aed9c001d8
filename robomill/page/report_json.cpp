#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/io/usual_ranges.hpp"
#include "robomill/page/json.hpp"
#include "robomill/page/thin.hpp"

namespace robomill::page {
namespace {

using io::Json;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_rows = 6000;  ///< of a list, of a revolution
constexpr int deepest_nesting = 256;
constexpr std::size_t most_lines = 12000;   ///< of an axis that all FRFs of a document share
constexpr std::size_t most_blocks = 40000;  ///< of a path in three dimensions

double number_of(const Json& value) {
  return value.is_number() ? value.get<double>() : missing;
}

double number_in(const Json& row, const std::string& key) {
  const auto cell = row.find(key);
  return cell == row.end() ? missing : number_of(*cell);
}

bool truth_in(const Json& row, const std::string& key) {
  const auto cell = row.find(key);
  return cell != row.end() && cell->is_boolean() && cell->get<bool>();
}

/// As a count or an axis: its extremes are no more than the ends of a run.
bool never_decreases(const Eigen::VectorXd& values) {
  return values.allFinite() && std::is_sorted(values.begin(), values.end());
}

/// What draws long curves over one axis like the whole ones; axes and counts follow.
std::vector<Eigen::Index> thin_curves(const std::vector<Eigen::VectorXd>& columns, std::size_t most) {
  std::vector<Eigen::VectorXd> curves;
  std::ranges::remove_copy_if(columns, std::back_inserter(curves), never_decreases);
  return thin_together(curves.empty() ? columns : curves, static_cast<Eigen::Index>(most));
}

/// Both rows wherever a truth value changes, the first of them: where a program goes into the material and out.
std::vector<Eigen::Index> changes(const Json& rows, const std::set<std::string>& keys, std::size_t most) {
  std::vector<Eigen::Index> keep;
  for (std::size_t i = 1; i < rows.size() && keep.size() < most; ++i) {
    const auto changes_here = [&](const std::string& key) {
      return truth_in(rows[i], key) != truth_in(rows[i - 1], key);
    };
    if (std::ranges::none_of(keys, changes_here)) continue;
    keep.push_back(static_cast<Eigen::Index>(i - 1));
    keep.push_back(static_cast<Eigen::Index>(i));
  }
  return keep;
}

/// Rows that hold an extreme of some column, run by run, or a change of a truth value.
Json thinned_rows(Json rows) {
  std::set<std::string> keys;
  std::set<std::string> truths;
  for (const Json& row : rows) {
    for (const auto& [key, value] : row.items()) {
      if (value.is_number()) keys.insert(key);
      if (value.is_boolean()) truths.insert(key);
    }
  }
  std::vector<Eigen::VectorXd> columns;
  for (const std::string& key : keys) {
    Eigen::VectorXd& column = columns.emplace_back(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) column[static_cast<Eigen::Index>(i)] = number_in(rows[i], key);
  }
  // Rows without a number are as good as each other.
  if (columns.empty()) columns.emplace_back(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(rows.size())));
  std::vector<Eigen::Index> keep = changes(rows, truths, most_rows / 3);
  std::ranges::copy(thin_curves(columns, most_rows - keep.size()), std::back_inserter(keep));
  std::ranges::sort(keep);
  keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
  Json kept = Json::array();
  for (const Eigen::Index i : keep) kept.push_back(std::move(rows[static_cast<std::size_t>(i)]));
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

/// Everything over an axis of so many values keeps the same ones.
void keep_of_axis(Json& json, std::size_t length, const std::vector<Eigen::Index>& keep) {
  std::vector<Json*> lists;
  collect(json, length, lists);
  for (Json* list : lists) {
    Json kept = Json::array();
    for (const Eigen::Index i : keep) kept.push_back((*list)[static_cast<std::size_t>(i)]);
    *list = std::move(kept);
  }
}

/// The lines at which some |H| has an extreme, run by run.
void thin_frfs(Json& json) {
  if (!json.is_object() || !json.contains("receptance_m_per_n")) return;
  json.erase("deviation_m_per_n");  // no page draws it
  const std::size_t lines = json["frequency_hz"].size();
  if (lines <= most_lines) return;
  std::vector<Eigen::VectorXd> magnitudes;
  for (const Json& frf : json["receptance_m_per_n"]) {
    Eigen::VectorXd& magnitude = magnitudes.emplace_back(static_cast<Eigen::Index>(lines));
    for (std::size_t i = 0; i < lines; ++i) {
      const Json& re = frf.at("re").at(i);
      const Json& im = frf.at("im").at(i);
      const bool known = re.is_number() && im.is_number();
      magnitude[static_cast<Eigen::Index>(i)] = known ? std::hypot(re.get<double>(), im.get<double>()) : missing;
    }
  }
  keep_of_axis(json, lines, thin_together(magnitudes, most_lines));
}

/// What the page draws of each block of a program; its tables are made of the worst blocks.
constexpr const char* drawn_columns[] = {"block",
                                         "line",
                                         "x_mm",
                                         "y_mm",
                                         "z_mm",
                                         "peak_f_n",
                                         "revolution_torque_n_m",
                                         "peak_torque_n_m",
                                         "path_mm",
                                         "time_s",
                                         "cuts",
                                         "sustained_power_w",
                                         "peak_deflection_um"};

void keep_drawn(Json& block) {
  Json drawn = Json::object();
  for (const char* column : drawn_columns) {
    if (const auto cell = block.find(column); cell != block.end()) drawn[column] = std::move(*cell);
  }
  block = std::move(drawn);
}

/// The places of an axis of so many values at which a curve over it has an extreme, run by run.
void thin_axis(Json& json, std::size_t length) {
  if (length <= most_rows) return;
  std::vector<Json*> lists;
  collect(json, length, lists);
  std::vector<Eigen::VectorXd> curves;
  for (const Json* list : lists) {
    Eigen::VectorXd& curve = curves.emplace_back(static_cast<Eigen::Index>(length));
    for (std::size_t i = 0; i < length; ++i) curve[static_cast<Eigen::Index>(i)] = number_of((*list)[i]);
  }
  keep_of_axis(json, length, thin_curves(curves, most_rows));
}

/// Of forces.json what the page shows.
void thin_forces(Json& json) {
  if (!json.is_object() || !json.contains("force_on")) return;
  json.erase("skipped");
  if (const auto blocks = json.find("blocks"); blocks != json.end()) {
    for (Json& block : *blocks) keep_drawn(block);
  }
  if (const auto rotation = json.find("rotation_deg"); rotation != json.end()) thin_axis(json, rotation->size());
}

bool says_something(const Json& column) {
  return std::ranges::any_of(column, [](const Json& cell) { return !cell.is_null(); });
}

/// Of blocks.json all but the joints ("q1") and which blocks share an evaluation.
bool shown_of_blocks(std::string_view column) {
  const bool joint = column.starts_with('q') && column.find_first_not_of("0123456789", 1) == std::string_view::npos;
  return !joint && column != "evaluation";
}

/// Of blocks.json the columns that the page shows and that say something; of a long program the blocks at which one of
/// them has an extreme.
/// @throws Json::exception if the columns are no lists or have different lengths
void thin_path(Json& json) {
  if (!json.is_object() || !json.contains("limit_over")) return;
  Json& all = json.at("blocks");
  const std::size_t rows = all.at("block").size();
  Json drawn = Json::object();
  for (auto& [name, column] : all.items()) {
    if (!shown_of_blocks(name)) continue;
    if (!column.is_array() || column.size() != rows) throw Json::other_error::create(501, name, nullptr);
    if (says_something(column)) drawn[name] = std::move(column);
  }
  std::vector<Eigen::VectorXd> curves;
  for (const Json& column : drawn) {
    if (rows <= most_blocks) break;
    Eigen::VectorXd& curve = curves.emplace_back(static_cast<Eigen::Index>(rows));
    for (std::size_t i = 0; i < rows; ++i) curve[static_cast<Eigen::Index>(i)] = number_of(column[i]);
  }
  if (!curves.empty()) keep_of_axis(drawn, rows, thin_curves(curves, most_blocks));
  all = std::move(drawn);
}

/// The lines of each spectrum of a recorded cut.
void thin_recordings(Json& json) {
  if (!json.is_object() || !json.contains("recordings")) return;
  for (Json& recording : json["recordings"]) {
    if (recording.is_object() && recording.contains("amplitude")) thin_axis(recording, recording["amplitude"].size());
  }
}

/// The lines of the spectrum of a simulated cut.
void thin_vibration(Json& json) {
  if (!json.is_object() || !json.contains("displacement_um")) return;
  Json& spectrum = json["spectrum"];
  if (spectrum.is_object() && spectrum.contains("frequency_hz")) thin_axis(spectrum, spectrum["frequency_hz"].size());
}

/// Times keep their digits: of an hour, six are not a hundredth of a second.
bool is_time(std::string_view key) {
  return key.ends_with("_s") && !key.ends_with("_per_s");
}

/// Numbers to six digits, long lists of rows thinned.
Json shown(Json value, bool whole, int depth = 0) {
  if (value.is_number_float()) return whole ? io::number(value.get<double>()) : number(value.get<double>());
  if (!value.is_structured()) return value;
  if (depth > deepest_nesting) throw InvalidInput("nesting", "is too deep");
  if (value.is_array() && value.size() > most_rows && value.front().is_object()) value = thinned_rows(std::move(value));
  for (auto& [key, part] : value.items())
    part = shown(std::move(part), value.is_array() ? whole : is_time(key), depth + 1);
  return value;
}

/// What a page needs of a document.
Json document(const char* member, const std::string& text) {
  if (text.empty()) return nullptr;
  try {
    Json json = io::parsed(text);
    thin_frfs(json);
    thin_forces(json);
    thin_recordings(json);
    thin_vibration(json);
    thin_path(json);
    return shown(std::move(json), false);
  } catch (const InvalidInput&) {
    throw InvalidInput(member, "nests its values too deep");
  } catch (const Json::exception&) {
    throw InvalidInput(member, "is not the JSON document that it should be");
  }
}

Json texts(const std::vector<std::string>& lines) {
  Json list = Json::array();
  for (const std::string& line : lines) list.push_back(text(line));
  return list;
}

struct Member {
  const char* name;
  std::string Report::*text;
};

}  // namespace

Json page_data(const Report& report) {
  static constexpr Member members[] = {{"plan", &Report::plan},
                                       {"frf", &Report::frf},
                                       {"fitted", &Report::fitted},
                                       {"measured", &Report::measured},
                                       {"assembly", &Report::assembly},
                                       {"modes", &Report::modes},
                                       {"workpiece_modes", &Report::workpiece_modes},
                                       {"lobes", &Report::lobes},
                                       {"recordings", &Report::recordings},
                                       {"forces", &Report::forces},
                                       {"blocks", &Report::blocks},
                                       {"smooth", &Report::smooth},
                                       {"motion", &Report::motion},
                                       {"cell", &Report::cell},
                                       {"monitor", &Report::monitor},
                                       {"calibration", &Report::calibration},
                                       {"joint", &Report::joint},
                                       {"tools", &Report::tools},
                                       {"sweep", &Report::sweep},
                                       {"comparison", &Report::comparison},
                                       {"postures", &Report::postures},
                                       {"statistics", &Report::statistics},
                                       {"study_points", &Report::study_points},
                                       {"explanation", &Report::explanation},
                                       {"simulation", &Report::simulation},
                                       {"vibration", &Report::vibration},
                                       {"coefficients", &Report::coefficients},
                                       {"stiffness", &Report::stiffness}};
  Json json = Json::object();
  json["title"] = text(report.title);
  json["created"] = text(report.created);
  for (const Member& member : members) json[member.name] = document(member.name, report.*member.text);
  json["assumed"] = io::assumed_json(report.assumed);
  for (Json& one : json["assumed"]) {
    for (Json& part : one) {
      if (part.is_string()) part = text(part.get<std::string>());
    }
  }
  std::vector<std::string> notes = report.notes, warnings = report.warnings;
  std::ranges::move(io::take_warnings(notes), std::back_inserter(warnings));
  json["warnings"] = texts(warnings);
  json["notes"] = texts(notes);
  json["files"] = Json::array();
  for (const StageFile& file : report.files) {
    json["files"].push_back(
        {{"stage", text(file.stage)}, {"file", text(file.file)}, {"description", text(file.description)}});
  }
  return json;
}

std::string report_json(const Report& report) {
  return io::plain_text(page_data(report)) + "\n";
}

}  // namespace robomill::page
