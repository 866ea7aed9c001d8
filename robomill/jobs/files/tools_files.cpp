#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::jobs {
namespace {

using io::Json;
using io::number;

const decision::Operation* best_of(const ToolResult& tool) {
  return tool.recommendation && tool.recommendation->recommended ? &*tool.recommendation->recommended : nullptr;
}

/// Why there is no operation, where there is none, or how the recommended one was chosen; empty without a cut.
std::string reason_of(const ToolResult& tool) {
  return tool.recommendation ? tool.recommendation->reason : tool.no_cut;
}

/// Why a row has no operation, or what to know of it: the failure, the reason, then the notes.
std::string remark_of(const ToolResult& tool) {
  if (!tool.failure.empty()) return tool.failure;
  std::string text = best_of(tool) == nullptr ? reason_of(tool) : "";
  for (const std::string& note : tool.notes) text += (text.empty() ? "" : "; ") + note;
  return text;
}

/// In the file's unit; empty where there is none.
std::string cell(double value, double unit, bool known = true) {
  return known ? fmt::format("{:.6g}", value / unit) : std::string();
}

/// What a row has of plan.json's operation.
Json recommended_json(const decision::Operation* op) {
  Json json;
  if (op == nullptr) return json;
  const Json all = operation_table().write(*op);
  for (const char* key :
       {"spindle_speed_rpm", "axial_depth_mm", "window_limit_mm", "removal_rate_mm3_per_s", "limited_by"}) {
    json[key] = all[key];
  }
  return json;
}

Json tool_json(const ToolResult& tool) {
  Json modes = Json::array();
  for (const modal::Mode& mode : tool.modes.modes) {
    modes.push_back({{"frequency_hz", number(mode.frequency_hz)}, {"damping_ratio", number(mode.damping_ratio)}});
  }
  const bool done = tool.failure.empty();
  Json json;
  json["tool"] = tool.name;
  json["teeth"] = tool.teeth > 0 ? Json(tool.teeth) : Json();
  json["diameter_mm"] = number(tool.diameter_m / units::mm);
  json["overhang_mm"] = number(tool.overhang_m / units::mm);
  json["failure"] = done ? Json() : Json(tool.failure);
  json["peak_hz"] = done ? number(tool.peak_hz) : Json();
  json["peak_um_per_n"] = done ? number(tool.peak_m_per_n / units::um) : Json();
  json["modes"] = modes;
  json["fit_relative_error"] = done ? number(tool.fit_error) : Json();
  json["suspect_lines"] = tool.suspect_lines;
  json["lowest_limit_mm"] = tool.lowest_limit_m ? number(*tool.lowest_limit_m / units::mm) : Json();
  json["recommended"] = recommended_json(best_of(tool));
  json["reason"] = tool.recommendation || !tool.no_cut.empty() ? Json(reason_of(tool)) : Json();
  json["notes"] = tool.notes;
  return json;
}

}  // namespace

std::string tools_csv(const std::vector<ToolResult>& results) {
  std::string out =
      "tool,teeth,diameter_mm,overhang_mm,peak_hz,peak_um_per_n,modes,mode_frequency_hz,mode_damping_ratio,"
      "lowest_limit_mm,spindle_speed_rpm,axial_depth_mm,removal_rate_mm3_per_s,remark\n";
  for (const ToolResult& tool : results) {
    const bool done = tool.failure.empty();
    const decision::Operation* best = best_of(tool);
    // The mode that the peak belongs to.
    const auto nearest =
        std::min_element(tool.modes.modes.begin(), tool.modes.modes.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.frequency_hz - tool.peak_hz) < std::abs(b.frequency_hz - tool.peak_hz);
        });
    const bool mode = nearest != tool.modes.modes.end();
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", io::csv_text(tool.name),
                       tool.teeth > 0 ? std::to_string(tool.teeth) : std::string(), cell(tool.diameter_m, units::mm),
                       cell(tool.overhang_m, units::mm), cell(tool.peak_hz, 1.0, done),
                       cell(tool.peak_m_per_n, units::um, done), tool.modes.modes.size(),
                       mode ? cell(nearest->frequency_hz, 1.0) : "", mode ? cell(nearest->damping_ratio, 1.0) : "",
                       cell(tool.lowest_limit_m.value_or(0.0), units::mm, tool.lowest_limit_m.has_value()),
                       best != nullptr ? cell(best->spindle_speed_rad_per_s, units::rpm) : "",
                       best != nullptr ? cell(best->axial_depth_m, units::mm) : "",
                       best != nullptr ? cell(best->removal_rate_m3_per_s, units::mm3) : "",
                       io::csv_text(remark_of(tool)));
  }
  return out;
}

std::string tools_json(const std::vector<ToolResult>& results, const std::optional<coupling::HolderResult>& holder) {
  Json tools = Json::array();
  for (const ToolResult& tool : results) tools.push_back(tool_json(tool));
  Json json;
  json["tools"] = tools;
  json["holder"] = holder ? Json{{"unreliable_hz", holder->unreliable_hz}, {"notes", holder->notes}} : Json();
  return io::dump(json);
}

void write_tips(const std::filesystem::path& folder, const std::vector<ToolResult>& results) {
  io::make_folder(folder);
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i].failure.empty()) continue;
    std::string name = results[i].name;
    for (char& letter : name) {
      if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '.') letter = '_';
    }
    modal::write_frfs(folder / fmt::format("{}_{}.uff", i + 1, name), results[i].tip);
  }
}

}  // namespace robomill::jobs
