#pragma once
#include <cstddef>
#include <string>

#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/http/server.hpp"

// Method: robomill/serve/README.md, "Interface"

namespace robomill::serve {

inline constexpr std::size_t most_edited_bytes = std::size_t{1} << 20;
inline constexpr const char* too_long_to_edit = "the text is longer than 1 MB";

/// POST /api/check: a text as the document that it is to be.
/// @param body  {"path", "text"}
/// @throws InvalidInput, io::Json::exception if the body is none
[[nodiscard]] HttpResponse check_text(const Folder& folder, const std::string& body);

/// POST /api/inspect: what a recording looks like.
/// @param body  {"path"}
/// @throws InvalidInput if it cannot be read, io::Json::exception if the body is none
[[nodiscard]] HttpResponse inspect_file(const Folder& folder, const std::string& body);

}  // namespace robomill::serve
