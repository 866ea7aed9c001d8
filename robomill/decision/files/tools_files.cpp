#include "robomill/decision/files/tools_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/decision/files/result_schema.hpp"
#include "robomill/decision/tools.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::decision {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::Use;

const Operation* best_of(const ToolResult& tool) {
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
const Schema<Operation>& tool_operation_table() {
  static const Schema<Operation> table(
      "tool_operation", "the best speed and depth of a tool",
      [] {
        std::vector<Row<Operation>> rows;
        for (const char* const name :
             {"spindle_speed_rpm", "axial_depth_mm", "window_limit_mm", "removal_rate_mm3_per_s", "limited_by"}) {
          rows.push_back(*std::ranges::find_if(operation_table().rows(),
                                               [name](const auto& row) { return row.key.name == name; }));
        }
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<modal::Mode>& tool_mode_table() {
  static const Schema<modal::Mode> table("tool_mode", "a mode at the tip of a tool",
                                         {key("frequency_hz", &modal::Mode::frequency_hz, "natural frequency"),
                                          key("damping_ratio", &modal::Mode::damping_ratio, "of critical damping")},
                                         Use::written);
  return table;
}

/// A number of a tool that did not fail.
Row<ToolResult> tool_number(const std::string& name, double ToolResult::*member, const std::string& meaning) {
  const auto value = [member](const ToolResult& tool) {
    return tool.failure.empty() ? std::optional(tool.*member) : std::nullopt;
  };
  return key(name, value, meaning).nullable();
}

const Schema<ToolResult>& tool_row_table() {
  using Tool = ToolResult;
  static const Schema<Tool> table(
      "tool_row", "what one tool of a list comes to in the holder",
      {key("tool", &Tool::name, "as the list names it"),
       key(
           "teeth", [](const Tool& tool) { return tool.teeth > 0 ? std::optional(tool.teeth) : std::nullopt; },
           "none: neither list nor cut gives them")
           .nullable(),
       key("diameter_mm", &Tool::diameter_m, "at the tip"),
       key("overhang_mm", &Tool::overhang_m, "from the tip to the joint"),
       key("failure", &Tool::failure, "why numbers are missing").nullable(),
       tool_number("peak_hz", &Tool::peak_hz, "where |xx| is greatest"),
       tool_number("peak_um_per_n", &Tool::peak_m_per_n, "|xx| there"),
       key(
           "modes", [](const Tool& tool) { return tool.modes.modes; }, tool_mode_table(), "fitted to the tip's FRFs"),
       tool_number("fit_relative_error", &Tool::fit_error, "of the fit"),
       key("suspect_lines", &Tool::suspect_lines, "where the measured holder would create energy"),
       key("lowest_limit_mm", &Tool::lowest_limit_m, "over all speeds; none: no cut, or stable at every depth")
           .nullable(),
       key(
           "recommended", [](const Tool& tool) { return best_of(tool); }, tool_operation_table(), "none: see reason")
           .nullable(),
       // Empty of a tool with a cut and nothing to explain.
       key(
           "reason",
           [](const Tool& tool) {
             return tool.recommendation || !tool.no_cut.empty() ? std::optional(reason_of(tool)) : std::nullopt;
           },
           "of the recommendation, or why there is none; none: no cut")
           .null_list(),
       key("notes", &Tool::notes, "sentences for the user")},
      Use::written);
  return table;
}

const Schema<coupling::HolderResult>& measured_holder_table() {
  using coupling::HolderResult;
  static const Schema<HolderResult> table(
      "measured_holder", "a holder that was measured",
      {key("unreliable_hz", &HolderResult::unreliable_hz, "lines where an error of its measurement becomes a large one")
           .exact(),
       key("notes", &HolderResult::notes, "sentences for the user")},
      Use::written);
  return table;
}

}  // namespace

std::string tools_csv(const std::vector<ToolResult>& results) {
  std::string out =
      "tool,teeth,diameter_mm,overhang_mm,peak_hz,peak_um_per_n,modes,mode_frequency_hz,mode_damping_ratio,"
      "lowest_limit_mm,spindle_speed_rpm,axial_depth_mm,removal_rate_mm3_per_s,remark\n";
  for (const ToolResult& tool : results) {
    const bool done = tool.failure.empty();
    const Operation* best = best_of(tool);
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

const Schema<ToolsView>& tools_table() {
  static const Schema<ToolsView> table(
      "tools", "tools of a list in one holder",
      {key(
           "tools", [](const ToolsView& view) { return *view.tools; }, tool_row_table(), "a row a tool"),
       key(
           "holder", [](const ToolsView& view) { return *view.holder; }, measured_holder_table(),
           "where it was measured")
           .nullable()},
      Use::written, 1);
  return table;
}

std::string tools_json(const std::vector<ToolResult>& results, const std::optional<coupling::HolderResult>& holder) {
  return io::dump(tools_table().write({&results, &holder}));
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

}  // namespace robomill::decision
