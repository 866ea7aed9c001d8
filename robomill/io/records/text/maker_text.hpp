#pragma once
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Programs of measurement whose text is more than a table: "key: value" lines above blocks of numbers.
enum class TextMaker : std::uint8_t { none, pulse, testlab };

/// By the first lines of a text.
[[nodiscard]] TextMaker text_maker_of(std::string_view content);
/// Of a regular file.
[[nodiscard]] TextMaker text_maker_of(const std::filesystem::path& path);

/// Reads the time signals that PULSE (Brüel & Kjær) and Testlab (Siemens, formerly LMS) export as text: one or several
/// blocks, each a header and rows of x and y, in PULSE behind a number. The rate is that of x, the unit that which the
/// header states. Spectra and complex functions are left out, with a note. By published descriptions: untried on a
/// real file, which a note says.
/// @throws InvalidInput with file and line if a block has no numbers or a row is damaged, or none is a time signal
[[nodiscard]] Record read_maker_text(const std::filesystem::path& path, std::string_view content, TextMaker maker);

}  // namespace robomill::io
