#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"

namespace robomill::serve {

/// What is wrong with a text that is to be saved as this document, of the kind that kind_of_toml() names; the files
/// that it names are read where its reader does so. None: nothing is, or the kind has no reader.
[[nodiscard]] std::optional<InvalidInput> check_document(std::string_view kind, const std::filesystem::path& path,
                                                         const std::string& text);

}  // namespace robomill::serve
