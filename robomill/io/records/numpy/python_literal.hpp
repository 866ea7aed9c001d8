#pragma once
// Of the reader of NPY.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace robomill::io {

/// A value of Python as a header writes it down.
struct PythonValue {
  enum class Kind { none, boolean, whole, text, list, dictionary };
  Kind kind = Kind::none;
  std::int64_t number = 0;  ///< 0 or 1 of a boolean
  std::string text = {};
  std::vector<PythonValue> items = {};  ///< of a list or tuple; of a dictionary the values
  std::vector<std::string> keys = {};   ///< of a dictionary

  /// Null where there is no such key.
  [[nodiscard]] const PythonValue* get(std::string_view key) const;
};

/// Of texts, whole numbers, True, False, None, and lists, tuples and dictionaries of these; nothing where the text is
/// anything else, or nested deeper than eight.
[[nodiscard]] std::optional<PythonValue> parse_python(std::string_view text);

}  // namespace robomill::io
