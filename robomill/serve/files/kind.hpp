#pragma once
#include <filesystem>
#include <string>
#include <string_view>

// Method: robomill/serve/README.md, "Files"

namespace robomill::serve {

/// What a file is.
struct FileKind {
  std::string kind = "other";  ///< "job", "hits", …; "frf", "modes", "record", "program", "report", "result", "other"
  std::string document = {};   ///< of a result which: "plan", "lobes", "vibration", …
  bool operator==(const FileKind&) const = default;
};

/// What the document is by its tables: "job", "hits", "lobes", "forces", "cell", "assembly", "monitor", …; "other".
[[nodiscard]] std::string kind_of_toml(std::string_view text);

/// By what stands at the beginning of a text, of other files by their ending.
[[nodiscard]] FileKind kind_of_file(const std::filesystem::path& path);

}  // namespace robomill::serve
