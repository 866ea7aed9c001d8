#include <cstddef>

#include "robomill/base/embed.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/init/template_lines.hpp"

#define ROBOMILL_EMBED_TEMPLATE(kind)                                             \
  ROBOMILL_EMBED(robomill_template_##kind, ROBOMILL_TEMPLATES "/" #kind ".toml"); \
  extern const char robomill_template_##kind##_begin[];                           \
  extern const char robomill_template_##kind##_end[];
#define ROBOMILL_TEMPLATE(kind) \
  case Template::kind:          \
    return text(robomill_template_##kind##_begin, robomill_template_##kind##_end);

extern "C" {
ROBOMILL_EMBED_TEMPLATE(job)
ROBOMILL_EMBED_TEMPLATE(hits)
ROBOMILL_EMBED_TEMPLATE(lobes)
ROBOMILL_EMBED_TEMPLATE(cell)
ROBOMILL_EMBED_TEMPLATE(assembly)
ROBOMILL_EMBED_TEMPLATE(forces)
ROBOMILL_EMBED_TEMPLATE(monitor)
}

namespace robomill::jobs {

std::string_view raw_template(Template kind) {
  const auto text = [](const char* begin, const char* end) {
    return std::string_view(begin, static_cast<std::size_t>(end - begin));
  };
  switch (kind) {
    ROBOMILL_TEMPLATE(job)
    ROBOMILL_TEMPLATE(hits)
    ROBOMILL_TEMPLATE(lobes)
    ROBOMILL_TEMPLATE(cell)
    ROBOMILL_TEMPLATE(assembly)
    ROBOMILL_TEMPLATE(forces)
    ROBOMILL_TEMPLATE(monitor)
  }
  return {};
}

std::string template_text(Template kind, bool example) {
  if (kind == Template::job) return rendered(with_tables(raw_template(kind), raw_template(Template::lobes)), example);
  return rendered(raw_template(kind), example);
}

}  // namespace robomill::jobs
