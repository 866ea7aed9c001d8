#pragma once
#include <optional>
#include <string_view>

namespace robomill::io {

/// Whether a table, or key, at the top of a document has a meaning to some reader. It has the same one in every
/// document, so that a reader leaves those of others alone.
[[nodiscard]] bool is_known_table(std::string_view name);

/// A key, or the beginning of several, that has a meaning to some reader of a table of which several know a part each:
/// "tool.mass_kg", "robot.joint_".
struct SharedKey {
  std::string_view name = {};
  bool begins = false;  ///< the keys that begin so are one reader's
};
/// That which a key is; nothing where no reader knows it.
[[nodiscard]] std::optional<SharedKey> shared_key(std::string_view key);

}  // namespace robomill::io
