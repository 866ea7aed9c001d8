#include "robomill/cutting/files/embedded_materials.hpp"

#include <cstddef>

#include "robomill/base/embed.hpp"

extern "C" {
ROBOMILL_EMBED(robomill_materials, ROBOMILL_MATERIALS);
extern const char robomill_materials_begin[];
extern const char robomill_materials_end[];
}

namespace robomill::cutting {

std::string_view embedded_materials() {
  return {robomill_materials_begin, static_cast<std::size_t>(robomill_materials_end - robomill_materials_begin)};
}

}  // namespace robomill::cutting
