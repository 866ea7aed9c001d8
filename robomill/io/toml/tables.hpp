#pragma once
#include <functional>
#include <optional>
#include <set>
#include <string>
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

/// The keys that a reader asked a document for, and which of the others are other readers'.
class AskedKeys {
 public:
  void add(std::string_view key) { keys_.emplace(key); }
  [[nodiscard]] const std::set<std::string, std::less<>>& all() const { return keys_; }
  [[nodiscard]] bool contains(std::string_view key) const { return keys_.contains(key); }
  /// Whether a key that begins so was asked for. @param joint  behind the key: "." of a table, "[" of a list
  [[nodiscard]] bool has_below(std::string_view key, std::string_view joint) const;
  /// Whether a key was asked for, or a table around it as a whole.
  [[nodiscard]] bool covers(std::string_view key) const;
  /// Whether nothing of this table was asked for, which readers of other tables know.
  [[nodiscard]] bool leaves_table(std::string_view table) const;
  /// Whether another reader of its table knows a key that this one did not ask for.
  [[nodiscard]] bool leaves_key(std::string_view key) const;

 private:
  std::set<std::string, std::less<>> keys_;
};

}  // namespace robomill::io
