#pragma once
#include <string>
#include <string_view>

/// The same page for a server: what it sends once, and what the page then fetches.
namespace robomill::page {

struct AppFiles {
  std::string_view style;        ///< web/page.css
  std::string_view script;       ///< empty in a build without npm
  std::string_view path_script;  ///< draws a path in three dimensions; empty as well
};
[[nodiscard]] AppFiles app_files();

/// The page of a folder: it loads page.css and page.js, and has {"token", "version", "folder"} as JSON in
/// #serve-config.
[[nodiscard]] std::string app_html(const std::string& folder, const std::string& write_token);

}  // namespace robomill::page
