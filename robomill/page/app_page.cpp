#include "robomill/page/app_page.hpp"

#include <fmt/format.h>

#include "robomill/page/embedded.hpp"
#include "robomill/page/escape.hpp"
#include "robomill/page/json.hpp"
#include "robomill/version.hpp"

namespace robomill::page {

AppFiles app_files() {
  return {.style = page_style(), .script = page_script(), .path_script = page_path_script()};
}

std::string app_html(const std::string& folder, const std::string& write_token) {
  const io::Json config = {{"token", write_token}, {"version", ROBOMILL_VERSION}, {"folder", text(folder)}};
  const char* const body = page_script().empty()
                               ? "<main><h1>robomill</h1><p class=\"notice\">This build has no page: build with npm, "
                                 "ROBOMILL_WEB=ON.</p></main>\n"
                               : "<div id=\"page\"></div>\n<noscript>This page needs JavaScript.</noscript>\n";
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>robomill: {}</title>\n"
      "<link rel=\"stylesheet\" href=\"page.css\">\n</head>\n<body>\n{}"
      "<script type=\"application/json\" id=\"serve-config\">{}</script>\n"
      "<script src=\"page.js\" defer></script>\n</body></html>\n",
      escape(folder), body, escape_json_for_script(io::plain_text(config)));
}

}  // namespace robomill::page
