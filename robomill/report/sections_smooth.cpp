#include <fmt/format.h>

#include <algorithm>

#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

/// "11.2 s for 16 blocks; the bound is 10.9 s (2.8 % below). No sample breaks a limit."
std::string verdict(const Json& smooth) {
  const Json& method = smooth["methods"][0];
  std::string out =
      fmt::format("<p class=\"why\"><strong>{} s</strong> for {} blocks by {}", significant(method["duration_s"]),
                  smooth["blocks"].get<std::size_t>(), escape(text_of(method["name"])));
  if (method["lower_bound_s"].is_number()) {
    const double over = method["duration_s"].get<double>() / method["lower_bound_s"].get<double>() - 1.0;
    out += fmt::format("; without jerk limits the same path takes {} s at least, {} less",
                       significant(method["lower_bound_s"]), percent(over / (1.0 + over), 1));
  }
  const auto violations = method["violations"].get<std::size_t>();
  out += violations == 0
             ? fmt::format(". None of {} samples breaks a limit.</p>\n", method["samples"].get<std::size_t>())
             : fmt::format(". <strong>{} times a sample breaks a limit.</strong></p>\n", violations);
  return out;
}

/// The columns that some method fills.
struct Column {
  const char* heading;
  std::string (*cell)(const Json& method);
  const char* shown_if;  ///< this key holds a number in some method; null: always
};

constexpr Column columns[] = {
    {"#Duration (s)", [](const Json& m) { return significant(m["duration_s"]); }, nullptr},
    {"#Bound (s)", [](const Json& m) { return significant(m["lower_bound_s"]); }, "lower_bound_s"},
    {"#Breaches of limits", [](const Json& m) { return fixed(m["violations"], 0); }, nullptr},
    {"#Joint limits used", [](const Json& m) { return percent(m["joint_share"], 0); }, "joint_share"},
    {"#Tip error (µm)", [](const Json& m) { return significant(m["tip_error_um"]); }, nullptr},
    {"#Axis error (°)", [](const Json& m) { return significant(m["axis_error_deg"]); }, nullptr},
    {"#Drives behind (°)", [](const Json& m) { return significant(m["tracking_error_deg"]); }, "tracking_error_deg"},
    {"#Drives behind (µm)", [](const Json& m) { return significant(m["tracking_error_um"]); }, "tracking_error_um"},
    {"#ΣT2 (s)", [](const Json& m) { return significant(m["sum_t2_s"]); }, "sum_t2_s"},
    {"#Planned in (s)", [](const Json& m) { return significant(m["plan_s"]); }, "plan_s"},
};

std::string methods_table(const Json& methods) {
  std::vector<std::string> headings = {"Method"};
  std::vector<const Column*> shown;
  for (const Column& column : columns) {
    const bool any = column.shown_if == nullptr || std::ranges::any_of(methods, [&](const Json& method) {
                       return method[column.shown_if].is_number();
                     });
    if (!any) continue;
    shown.push_back(&column);
    headings.emplace_back(column.heading);
  }
  Table table(methods.size() > 1 ? "Methods side by side" : "In short", headings);
  for (const Json& method : methods) {
    std::vector<std::string> cells = {escape(text_of(method["name"]))};
    for (const Column* column : shown) cells.push_back(column->cell(method));
    table.row(cells, method["violations"].get<std::size_t>() > 0 ? "chatter" : "");
  }
  return table.html();
}

std::string uses_table(const Json& method) {
  Table table(fmt::format("~Limits and what {} uses of them", escape(text_of(method["name"]))),
              {"", "#Largest", "#Limit", "Unit", "#Used", "#Samples beyond", "#At (s)", "#Block"});
  for (const Json& use : method["uses"]) {
    const auto violations = use["violations"].get<std::size_t>();
    const std::string beyond = violations > 0 ? fmt::format("<strong>{}</strong>", violations) : "0";
    table.row(
        {escape(text_of(use["what"])), significant(use["max"]), significant(use["limit"]), escape(text_of(use["unit"])),
         percent(use["share"], 1), beyond, significant(use["at_s"]), fixed(use["block"], 0)},
        violations > 0 ? "chatter" : "");
  }
  return table.html();
}

std::string plots_of(const Json& smooth) {
  std::string body =
      plot("smooth-path", "The programmed path and the tip's, seen from above and from the side, coloured by speed",
           "The programmed path grey, the tip's in the colour of its speed.");
  if (!smooth["corners"].empty()) {
    body += plot(
        "smooth-corners", "Sharp corners of the program seen close, with the tolerance and the tip's path",
        "Sharp corners of each kind, each in the plane of its two moves: within the shaded tube the tip is within its "
        "tolerance.");
  }
  body += plot("smooth-speed", "Speed of the tip and of the tool's axis over time",
               "Speed of the tip along its path, and of the axis below; dashed: their limits.");
  body +=
      plot("smooth-joint", "Velocity, acceleration, jerk and tracking error of one joint over time, with its limits",
           "One joint by differences of the samples; dashed: its limits.");
  return body;
}

}  // namespace

std::string smooth_section(const Json& report, bool plots) {
  const Json& smooth = report["smooth"];
  if (smooth.is_null()) return {};
  const Json& methods = smooth["methods"];
  std::string body = facts_list(smooth["facts"]) + warning_box("Before you run it", smooth["warnings"]) +
                     verdict(smooth) + methods_table(methods);
  if (plots && !methods[0]["motion"]["time_s"].empty()) body += plots_of(smooth);
  body += "<h3>Limits and what is used of them</h3>\n" + uses_table(methods[0]);
  for (std::size_t i = 1; i < methods.size(); ++i) {
    body += details("Limits used by " + text_of(methods[i]["name"]), uses_table(methods[i]));
  }
  if (!smooth["skipped"].empty()) {
    body += details(fmt::format("{} statements of the program that were left out", smooth["skipped"].size()),
                    bullet_list(smooth["skipped"]));
  }
  return section("smooth", "Smoothed program", "How the machine runs the program, and how near it comes to each limit.",
                 body + bullet_list(smooth["notes"]));
}

}  // namespace robomill::report
