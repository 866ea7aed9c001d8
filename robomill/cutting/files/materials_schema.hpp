#pragma once
#include "robomill/cutting/material.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cutting {

/// materials.NAME of materials.toml.
[[nodiscard]] const io::Schema<Material>& material_table();

}  // namespace robomill::cutting
