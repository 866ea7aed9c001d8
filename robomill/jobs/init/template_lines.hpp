#pragma once
#include <string>
#include <string_view>

namespace robomill::jobs {

/// A line of a template: `key = value`, and its remark where the others have theirs.
[[nodiscard]] std::string template_line(std::string_view key, std::string_view value, std::string_view remark);

/// A document with a key set (io::with_setting) and the remark of its line replaced. The key is one of a table.
[[nodiscard]] std::string with_remark(std::string_view document, const std::string& key, const std::string& value,
                                      std::string_view remark);

/// A document with the line of a key commented out, where it is not so already. The key's last part stands in one line
/// of the document alone.
[[nodiscard]] std::string commented_out(std::string document, std::string_view key);

}  // namespace robomill::jobs
