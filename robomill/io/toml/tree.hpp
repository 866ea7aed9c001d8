#pragma once
// For io/ alone: toml++ and its tree. It asserts, or even lets the compiler assume, what "[*]" breaks; without either
// it reports an error as it should. Sources with it are compiled on their own (CMakeLists.txt).
#undef NDEBUG
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::io {

/// toml++ bounds how deeply values nest, but not the parts of a dotted key; what takes a table apart calls itself once
/// a level. @throws InvalidInput with the line if a key has very many
void require_short_keys(std::string_view content, const std::string& where);

/// @param where  names the file in messages and in the tree's nodes
/// @throws InvalidInput with the line if it is no TOML, or has a key of very many parts
[[nodiscard]] toml::table parse_toml(std::string_view content, const std::string& where);

/// Takes "[3]" off the front of a path.
std::optional<std::size_t> take_index(std::string_view& path);

/// What a path leads to: "hits[0].file", tables of an array from 0; null where nothing is there.
[[nodiscard]] const toml::node* find_node(const toml::table& root, std::string_view path);

/// The key, or the innermost table around it that the file has; null where that is the file itself.
[[nodiscard]] const toml::node* nearest_node(const toml::table& root, std::string_view key);

/// Puts a value at a path below a node, with the tables that are missing on the way; false where there is no way.
bool put(toml::node& node, std::string_view path, const toml::node& value);

/// A value as the file has it; empty for tables and arrays.
[[nodiscard]] std::string value_text(const toml::node& node);

[[nodiscard]] bool is_list_of_tables(const toml::array& array);

/// Where places of toml++ (line and character from 1) stand among the bytes of a text.
class TextPlaces {
 public:
  explicit TextPlaces(std::string_view text);
  [[nodiscard]] std::size_t offset_of(const toml::source_position& place) const;

 private:
  std::string_view text_;
  std::vector<std::size_t> lines_;  ///< where each begins
};

}  // namespace robomill::io
