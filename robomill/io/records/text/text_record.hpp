#pragma once
#include <filesystem>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Reads a table of text: its columns, with the units of a row of units, and the rate that the lines above the numbers
/// state.
/// @throws InvalidInput with file and line, as parse_table
[[nodiscard]] Record read_text_record(const std::filesystem::path& path);

}  // namespace robomill::io
