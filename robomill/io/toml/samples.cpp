#include "robomill/io/toml/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/lines.hpp"

namespace robomill::io {
namespace {

constexpr std::string_view mark_begin = "# sample ";

bool is_name_letter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

/// A line with a mark: its value and what the mark says of it.
struct Marked {
  std::string_view value, mark;
  std::size_t begin = 0, end = 0;  ///< of the mark and the colon and blank behind it, in the line
};

std::optional<Marked> marked(std::string_view line) {
  const std::size_t at = line.find(mark_begin), equals = line.find('=');
  if (at == std::string_view::npos || equals > at) return std::nullopt;
  const std::size_t begin = at + 2;
  std::size_t end = std::min(line.find(':', begin), line.size());
  Marked out = {.value = trimmed(line.substr(equals + 1, at - equals - 1)),
                .mark = trimmed(line.substr(begin, end - begin)),
                .begin = begin};
  while (end < line.size() && (line[end] == ':' || line[end] == ' ')) ++end;
  out.end = end;
  return out;
}

}  // namespace

std::string sample_mark(std::string_view value) {
  std::string out = "sample";
  for (std::size_t at = 0; at < value.size();) {
    const char c = value[at];
    if (c == '"' || c == '\'') {
      const std::size_t end = std::min(value.find(c, at + 1), value.size());
      out += fmt::format(" {}", value.substr(at + 1, end - at - 1));
      at = std::min(end + 1, value.size());
    } else if (is_name_letter(c) || c == '+' || c == '.') {
      std::size_t end = at;
      while (end < value.size() && (is_name_letter(value[end]) || value[end] == '+' || value[end] == '.')) ++end;
      const bool is_key = trimmed(value.substr(end)).starts_with('=');
      if (!is_key) out += fmt::format(" {}", value.substr(at, end - at));
      at = end;
    } else {
      ++at;
    }
  }
  return out;
}

std::vector<Assumption> sample_values(const TomlFile& document) {
  std::vector<Assumption> out;
  for (const TomlText& text : document.texts()) {
    for (const TomlLine& line : toml_lines(text.content)) {
      const std::optional<Marked> found = line.is_comment ? std::nullopt : marked(line.text);
      if (!found || found->mark != sample_mark(found->value) || !document.took(line.key)) continue;
      out.push_back({.what = sample_left,
                     .taken = std::string(found->value),
                     .key = shown_key(line.key),
                     .file = text.path.filename().string()});
    }
  }
  return out;
}

std::string without_sample_mark(std::string document, std::string_view key) {
  const std::string_view whole = key.substr(0, key.ends_with(']') ? key.rfind('[') : key.size());
  for (const TomlLine& line : toml_lines(document)) {
    if (line.is_comment || (line.key != key && line.key != whole)) continue;
    const std::optional<Marked> found = marked(line.text);
    if (!found) return document;
    const auto begin = static_cast<std::size_t>(line.text.data() - document.data());
    document.erase(begin + found->begin, found->end - found->begin);
    const bool alone = found->end == line.text.size();  // a comment of the mark alone
    if (alone) document.erase(begin + found->begin - 2, 2);
    return document;
  }
  return document;
}

}  // namespace robomill::io
