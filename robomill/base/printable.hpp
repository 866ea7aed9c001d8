#pragma once
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"

namespace robomill {

/// Text as a terminal may have it: what moves its cursor, changes its state or turns the direction of writing (control
/// characters, line ends too, and those of Unicode) and what is no UTF-8 stands there as \n, \t or \xHH, byte by byte.
/// What comes out comes out again unchanged.
[[nodiscard]] ROBOMILL_API std::string printable(std::string_view text);

/// The same, with line ends before two blanks kept: lines that a message has below each other, to be copied.
[[nodiscard]] ROBOMILL_API std::string printable_lines(std::string_view text);

}  // namespace robomill
