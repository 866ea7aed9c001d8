#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::io {

/// A line of a TOML text that sets a key, or would without its #.
struct TomlLine {
  std::string key;          ///< "tool.teeth", "hits[0].file"; tables of an array count from 0
  std::string_view text;    ///< the line as it stands, without its end
  std::size_t number = 0;   ///< from 1
  bool is_comment = false;  ///< "# teeth = 3"
};

/// Those whose key is plain; what stands within a value of several lines may be among them.
[[nodiscard]] std::vector<TomlLine> toml_lines(std::string_view text);

/// "hits[0].file" as messages show it, counted from 1.
[[nodiscard]] std::string shown_key(std::string_view key);

}  // namespace robomill::io
