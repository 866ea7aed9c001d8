#pragma once
#include <string_view>

/// What the build put into the library for the page.
namespace robomill::page {

/// The style sheet, web/page.css.
[[nodiscard]] std::string_view page_style();
/// The script that draws the plots, as Vite bundled it; empty in a build without it.
[[nodiscard]] std::string_view page_script();
/// The script that draws a path in three dimensions, for pages that have one; empty in a build without scripts.
[[nodiscard]] std::string_view page_path_script();

}  // namespace robomill::page
