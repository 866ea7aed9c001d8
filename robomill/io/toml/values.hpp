#pragma once
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/json.hpp"

namespace robomill::io {

/// A value of a TOML text, where it stands and what is said of it.
struct TomlValue {
  std::string key;      ///< "tool.teeth", "hits[0].file"; counted from 0
  Json value;           ///< number, text, boolean or a list of them
  int line = 0;         ///< from 1
  std::string comment;  ///< behind the value, or in the lines above it; empty: none
};

/// The values of a text in its order; tables are taken apart, lists of plain values are one value.
/// @param file  names the text in errors
/// @param most  that are given; which are left out of a text that has more is not said
/// @throws InvalidInput with file and line if it is no TOML
[[nodiscard]] std::vector<TomlValue> toml_values(std::string_view text, const std::string& file,
                                                 std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace robomill::io
