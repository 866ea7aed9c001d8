#include <fmt/format.h>

#include <array>
#include <utility>

#include "robomill/report/html.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/page.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

/// Nothing may be fetched: the policy forbids it, whatever a text in the data says.
constexpr const char* policy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'";

std::string header(const Json& report) {
  std::string out = "<header><h1>" + escape(text_of(report["title"])) + "</h1>\n";
  if (!text_of(report["created"]).empty())
    out += "<p class=\"created\">" + escape(text_of(report["created"])) + "</p>\n";
  out += facts_list(report["facts"]);
  return out + "</header>\n";
}

std::string warnings(const Json& report) {
  if (report["warnings"].empty()) return {};
  return "<aside class=\"warnings\" aria-label=\"Warnings\"><h2>Before you use these numbers</h2>\n" +
         bullet_list(report["warnings"]) + "</aside>\n";
}

std::string navigation(const std::string& body) {
  constexpr auto entries = std::to_array<std::pair<const char*, const char*>>({{"monitor", "Monitor"},
                                                                               {"calibration", "Calibration"},
                                                                               {"lobes", "Lobes"},
                                                                               {"feed", "Feed direction"},
                                                                               {"forces", "Forces"},
                                                                               {"smooth", "Smoothed program"},
                                                                               {"assembly", "Tool and holder"},
                                                                               {"frf", "Frequency response"},
                                                                               {"modes", "Modes"},
                                                                               {"pairs", "Which modes matter"},
                                                                               {"recordings", "Recorded cuts"},
                                                                               {"hits", "Hits"},
                                                                               {"notes", "Notes"}});
  std::string links;
  for (const auto& [id, label] : entries) {
    if (body.find(fmt::format("<section id=\"{}\"", id)) == std::string::npos) continue;
    links += fmt::format("<a href=\"#{}\">{}</a>", id, label);
  }
  return links.empty() ? links : "<nav aria-label=\"Sections\">" + links + "</nav>\n";
}

}  // namespace

std::string section(const char* id, const char* heading, const char* lead, const std::string& body) {
  if (body.empty()) return {};
  return fmt::format("<section id=\"{}\"><h2>{}</h2>\n<p class=\"lead\">{}</p>\n{}</section>\n", id, heading, lead,
                     body);
}

std::string plot(const char* which, const std::string& shows, const char* caption) {
  return fmt::format(
      "<figure data-plot=\"{}\"><div class=\"canvas\" role=\"img\" aria-label=\"{}\"></div>\n"
      "<figcaption>{}</figcaption></figure>\n",
      escape(which), escape(shows), caption);
}

std::string report_html(const Report& report) {
  const Json json = shop_units(report);
  const std::string_view script = page_script();
  const bool plots = !script.empty();
  const std::string body = monitor_section(json, plots) + calibration_section(json, plots) +
                           lobes_section(json, plots) + feed_section(json, plots) + forces_section(json, plots) +
                           smooth_section(json, plots) + assembly_section(json) + frf_section(json, plots) +
                           modes_section(json, plots) + pairs_section(json, plots) + recordings_section(json, plots) +
                           hits_section(json) + notes_section(json);
  std::string page = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
  page += fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", policy);
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<meta name=\"color-scheme\" content=\"light dark\">\n";
  page += "<link rel=\"icon\" href=\"data:,\">\n<title>" + escape(text_of(json["title"])) + "</title>\n<style>\n";
  page += page_style();
  page += "</style></head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the recommendation</a>\n";
  page += header(json) + navigation(body) + "<main id=\"main\">\n";
  page +=
      plots ? "<noscript><p class=\"notice\">The plots need JavaScript; the tables do not.</p></noscript>\n"
            : "<p class=\"notice\">Plots were left out of this build of robomill. The numbers are in the tables.</p>\n";
  page += recommendation_section(json) + warnings(json) + body + "</main>\n";
  if (plots) {
    page += "<script type=\"application/json\" id=\"report-data\">" + escape_json_for_script(json.dump()) +
            "</script>\n<script>\n";
    page += script;
    page += "\n</script>\n";
  }
  return page + "</body></html>\n";
}

}  // namespace robomill::report
