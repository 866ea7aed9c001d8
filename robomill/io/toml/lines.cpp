#include "robomill/io/toml/lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

/// The name before an equals sign; empty where the line sets no key.
std::string_view key_of(std::string_view line) {
  const std::string_view name = trimmed(line.substr(0, line.find('=')));
  const bool plain = line.find('=') != std::string_view::npos &&
                     name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.") ==
                         std::string_view::npos;
  return plain ? name : std::string_view();
}

/// "[tool]" or "[[hits]]", with nothing but a remark behind it.
bool is_header(std::string_view line) {
  const std::size_t close = line.find(']');
  if (!line.starts_with('[') || close == std::string_view::npos) return false;
  const std::size_t end = line.find_first_not_of("] \t", close);
  return end == std::string_view::npos || line[end] == '#';
}

}  // namespace

std::vector<TomlLine> toml_lines(std::string_view text) {
  std::vector<TomlLine> out;
  // A header behind a # is that of the keys behind a # below it: the next live key is still of the live table.
  std::string table, of_comments;
  std::map<std::string, std::size_t, std::less<>> entries;  ///< of each array of tables, so far
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::string_view rest = trimmed(line);
    const bool comment = rest.starts_with('#');
    if (comment) rest = trimmed(rest.substr(1));
    const bool array = rest.starts_with("[[");
    if (is_header(rest)) {
      const std::size_t begin = array ? 2 : 1;
      of_comments = trimmed(rest.substr(begin, rest.find(']') - begin));
      if (array) {
        const std::size_t index = comment ? entries[of_comments] : entries[of_comments]++;
        of_comments += fmt::format("[{}]", index);
      }
      if (!comment) table = of_comments;
      continue;
    }
    const std::string_view key = key_of(rest);
    if (key.empty()) continue;
    if (!comment) of_comments = table;
    out.push_back({.key = of_comments.empty() ? std::string(key) : fmt::format("{}.{}", of_comments, key),
                   .text = line,
                   .number = number,
                   .is_comment = comment});
  }
  return out;
}

std::string shown_key(std::string_view key) {
  std::string text;
  while (!key.empty()) {
    const std::size_t open = key.find('[');
    text += key.substr(0, open);
    if (open == std::string_view::npos) break;
    key.remove_prefix(open + 1);
    std::size_t index = 0;
    const std::from_chars_result read = std::from_chars(key.data(), key.data() + key.size(), index);
    text += fmt::format("[{}", index + 1);
    key.remove_prefix(static_cast<std::size_t>(read.ptr - key.data()));
  }
  return text;
}

}  // namespace robomill::io
