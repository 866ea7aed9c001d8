#pragma once
#include <string_view>

namespace robomill::cutting {

/// data/materials.toml, as it was when the library was built.
[[nodiscard]] std::string_view embedded_materials();

}  // namespace robomill::cutting
