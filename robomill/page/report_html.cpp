#include <fmt/format.h>

#include <string>
#include <string_view>

#include "robomill/page/embedded.hpp"
#include "robomill/page/escape.hpp"
#include "robomill/page/json.hpp"

namespace robomill::page {
namespace {

/// Nothing may be fetched: the policy forbids it, whatever a text in the data says.
constexpr const char* policy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'";

/// What stands where no script runs.
std::string in_text(const std::string& title, const std::string& summary, const char* why) {
  return fmt::format("<main><h1>{}</h1>\n<p class=\"notice\">{}</p>\n<pre>{}</pre></main>", escape(title), why,
                     escape(summary));
}

void append_script(std::string& page, std::string_view script) {
  if (script.empty()) return;
  page += "<script>\n";
  page += script;
  page += "\n</script>\n";
}

}  // namespace

std::string report_html(const Report& report) {
  const io::Json json = page_data(report);
  const std::string title = json["title"];
  const std::string summary = text(report.summary);
  const std::string_view script = page_script();
  std::string page = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
  page += fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", policy);
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<meta name=\"color-scheme\" content=\"light dark\">\n";
  page += "<link rel=\"icon\" href=\"data:,\">\n<title>" + escape(title) + "</title>\n<style>\n";
  page += page_style();
  page += "</style></head>\n<body>\n";
  if (script.empty()) {
    page += in_text(title, summary, "Tables and plots were left out of this build of robomill.") + "\n";
  } else {
    page += "<div id=\"page\"></div>\n<noscript>" +
            in_text(title, summary, "Tables and plots need JavaScript. This is the summary.") + "</noscript>\n";
  }
  page += "<script type=\"application/json\" id=\"report-data\">" + escape_json_for_script(io::plain_text(json)) +
          "</script>\n";
  if (!json["blocks"].is_null()) append_script(page, page_path_script());
  append_script(page, script);
  return page + "</body></html>\n";
}

}  // namespace robomill::page
