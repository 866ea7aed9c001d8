#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/material.hpp"
#include "robomill/io/toml_source.hpp"

// Method: robomill/cutting/README.md, "Files"

namespace robomill::cutting {

/// A file as data/materials.toml. @param notes  gains sentences for the user
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API std::vector<Material> read_materials(const io::TomlSource& source,
                                                                std::vector<std::string>& notes);

/// Those of data/materials.toml, which the library carries with it, in its order.
[[nodiscard]] ROBOMILL_API const std::vector<Material>& materials();

/// By its name or another one, whatever their case, hyphens, underscores and spaces.
/// @throws InvalidInput "material" that lists those known and names the nearest
[[nodiscard]] ROBOMILL_API const Material& material(std::string_view name);

}  // namespace robomill::cutting
