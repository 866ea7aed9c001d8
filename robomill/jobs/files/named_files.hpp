#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "robomill/io/json.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::jobs {

/// Of a TOML document that is read for what it names [byte].
inline constexpr std::uintmax_t longest_document = std::uintmax_t{1} << 20;

/// What becomes of a document that cannot be read.
enum class Unreadable {
  left_out,  ///< it names no file
  rejected   ///< InvalidInput
};

/// The files that a TOML document names, and those that the documents among them name: every text of it that leads from
/// its folder to a file that is there. None of a file that is no such document.
/// @throws InvalidInput if they are too many: 64 documents, 8 MB of them, or 10,000 files
[[nodiscard]] std::vector<std::filesystem::path> files_named_in(const std::filesystem::path& document,
                                                                Unreadable unreadable = Unreadable::left_out);

/// Of values, the files that their texts lead to from a folder, each once.
/// @throws InvalidInput if they are more than 10,000
[[nodiscard]] std::vector<std::filesystem::path> files_named_by(const std::vector<io::Json>& values,
                                                                const std::filesystem::path& folder);

}  // namespace robomill::jobs
