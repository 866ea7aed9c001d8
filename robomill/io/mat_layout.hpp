#pragma once
#include <cstddef>
#include <optional>
#include <string_view>

namespace robomill::io {

/// The variables of a MAT file by the lengths that they state.
struct MatLayout {
  std::size_t variables = 0;  ///< that are there from begin to end
  bool whole = false;         ///< nothing behind them: else the file ends within a variable
};

/// None where the bytes are no MAT file of version 4 or 5, or one with lengths that make no sense.
/// Source: [MathWorks2024] "MAT-File Format", level 5, "Data Elements"; level 4, "Header Format"
[[nodiscard]] std::optional<MatLayout> mat_layout(std::string_view bytes);

}  // namespace robomill::io
