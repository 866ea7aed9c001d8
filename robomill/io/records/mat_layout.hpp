#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::io {

/// The variables of a MAT file by the lengths that they state.
struct MatLayout {
  std::size_t variables = 0;  ///< that are there from begin to end
  bool whole = false;         ///< nothing behind them: else the file ends within a variable
};

/// None where the bytes are no MAT file of version 4 or 5, or one with lengths that make no sense.
/// Source: [MathWorks2024] "MAT-File Format", level 5, "Data Elements"; level 4, "Header Format"
[[nodiscard]] std::optional<MatLayout> mat_layout(std::string_view bytes);

/// The names of the variables of a MAT file of version 4 or 5, out of the first bytes of each, by no library that reads
/// MAT files: of the first thousand, as far as they make sense.
[[nodiscard]] std::vector<std::string> mat_names(std::string_view bytes);

/// Before memory is asked for: zlib packs at most some thousand to one.
/// @throws InvalidInput if a variable says that it holds more than its file can
void require_held(const std::string& file, const std::string& variable, std::uint64_t rows, std::uint64_t columns,
                  std::size_t value_bytes, std::size_t file_bytes);

}  // namespace robomill::io
