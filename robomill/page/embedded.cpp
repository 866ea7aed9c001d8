#include "robomill/page/embedded.hpp"

#include <cstddef>

#include "robomill/base/embed.hpp"

extern "C" {
ROBOMILL_EMBED(robomill_page_style, ROBOMILL_PAGE_STYLE);
extern const char robomill_page_style_begin[];
extern const char robomill_page_style_end[];
#ifdef ROBOMILL_PAGE_SCRIPT
ROBOMILL_EMBED(robomill_page_script, ROBOMILL_PAGE_SCRIPT);
extern const char robomill_page_script_begin[];
extern const char robomill_page_script_end[];
ROBOMILL_EMBED(robomill_page_path_script, ROBOMILL_PAGE_PATH_SCRIPT);
extern const char robomill_page_path_script_begin[];
extern const char robomill_page_path_script_end[];
#endif
}

namespace robomill::page {

std::string_view page_style() {
  return {robomill_page_style_begin, static_cast<std::size_t>(robomill_page_style_end - robomill_page_style_begin)};
}

std::string_view page_script() {
#ifdef ROBOMILL_PAGE_SCRIPT
  return {robomill_page_script_begin, static_cast<std::size_t>(robomill_page_script_end - robomill_page_script_begin)};
#else
  return {};
#endif
}

std::string_view page_path_script() {
#ifdef ROBOMILL_PAGE_SCRIPT
  return {robomill_page_path_script_begin,
          static_cast<std::size_t>(robomill_page_path_script_end - robomill_page_path_script_begin)};
#else
  return {};
#endif
}

}  // namespace robomill::page
