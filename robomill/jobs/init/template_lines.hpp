#pragma once
#include <string>
#include <string_view>

#include "robomill/jobs/init.hpp"

namespace robomill::jobs {

/// The document as it stands in templates/. A remark that begins with a mark is that of a value which is made up:
/// "#! mm" must be given, "#? mm" may be, "#= mm" is a choice that serves to begin with.
[[nodiscard]] std::string_view raw_template(Template kind);

/// A raw document for people. Of an example every marked value is a sample (io::sample_mark); else those of "#!" and
/// "#?" stand behind a #.
[[nodiscard]] std::string rendered(std::string_view raw, bool example);

/// A raw document whose lines "#+ tool" and "#+ [cut]" are replaced by tables of another one: by the keys of the first,
/// by the second as a whole.
[[nodiscard]] std::string with_tables(std::string_view raw, std::string_view other);
/// The same without these lines.
[[nodiscard]] std::string without_tables(std::string_view raw);

/// A line of a template: `key = value`, and its remark where the others have theirs.
/// @param mark  "#", or that of a raw document
[[nodiscard]] std::string template_line(std::string_view key, std::string_view value, std::string_view remark,
                                        std::string_view mark = "#");

/// A document with a key set (io::with_setting) and the remark of its line replaced. The key is one of a table.
[[nodiscard]] std::string with_remark(std::string_view document, const std::string& key, const std::string& value,
                                      std::string_view remark, std::string_view mark = "#");

/// A document with the line of a key commented out, where it is not so already. The key's last part stands in one line
/// of the document alone.
[[nodiscard]] std::string commented_out(std::string document, std::string_view key);

}  // namespace robomill::jobs
