#pragma once
#include <string_view>

namespace robomill::io {

/// Whether a table, or key, at the top of a document has a meaning to some reader. It has the same one in every
/// document, so that a reader leaves those of others alone.
[[nodiscard]] bool is_known_table(std::string_view name);

/// Whether a key has a meaning to some reader of a table that several readers know, each a part of it: "tool.teeth",
/// "tool.mass_kg".
[[nodiscard]] bool is_shared_key(std::string_view key);

}  // namespace robomill::io
