#include "robomill/io/toml/tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/edit.hpp"

namespace robomill::io {
namespace {

constexpr int most_key_parts = 32;

/// One past the end of the text or comment that begins at `at`; `at` where neither does.
std::size_t skip_text(std::string_view content, std::size_t at) {
  const auto after = [&](std::string_view closing, std::size_t from, bool escapes) {
    for (std::size_t i = from; i < content.size(); ++i) {
      if (content.substr(i).starts_with(closing)) return i + closing.size();
      if (closing.size() == 1 && content[i] == '\n') return i;  // unclosed
      if (escapes && content[i] == '\\') ++i;
    }
    return content.size();
  };
  const char quote = content[at];
  if (quote == '#') return std::min(content.find('\n', at), content.size());
  if (quote != '"' && quote != '\'') return at;
  const std::string three(3, quote);
  if (!content.substr(at).starts_with(three)) return after(three.substr(2), at + 1, quote == '"');
  std::size_t end = after(three, at + 3, quote == '"');
  // Up to two quotes of the text itself may stand before the three that close it.
  for (int own = 0; own < 2 && end < content.size() && content[end] == quote; ++own) ++end;
  return end;
}

}  // namespace

std::optional<std::size_t> take_index(std::string_view& path) {
  if (path.empty() || path.front() != '[') return std::nullopt;
  std::size_t index = 0;
  const std::from_chars_result read = std::from_chars(path.data() + 1, path.data() + path.size(), index);
  const std::size_t used = static_cast<std::size_t>(read.ptr - path.data());
  if (read.ec != std::errc() || used >= path.size() || path[used] != ']') return std::nullopt;
  path.remove_prefix(used + 1);
  return index;
}

void require_short_keys(std::string_view content, const std::string& where) {
  int parts = 1;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const std::size_t end = skip_text(content, i);
    if (end > i) {
      i = end - 1;
      continue;
    }
    const char letter = content[i];
    if (letter == '.') {
      ++parts;
    } else if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '_' &&
               letter != ' ' && letter != '\t') {
      parts = 1;
    }
    if (parts <= most_key_parts) continue;
    const auto line = std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(i), '\n') + 1;
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", where, line),
                                           .rule = fmt::format("has a key of more than {} parts", most_key_parts)});
  }
}

toml::table parse_toml(std::string_view content, const std::string& where) {
  require_short_keys(content, where);
  try {
    return toml::parse(content, where);
  } catch (const toml::parse_error& error) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", where, error.source().begin.line),
                                           .rule = "is no TOML: " + std::string(error.description())});
  }
}

const toml::node* find_node(const toml::table& root, std::string_view path) {
  const toml::node* node = &root;
  while (node != nullptr && !path.empty()) {
    if (path.front() == '[') {
      const std::optional<std::size_t> index = take_index(path);
      const toml::array* array = node->as_array();
      node = index && array != nullptr ? array->get(*index) : nullptr;
    } else {
      if (path.front() == '.') path.remove_prefix(1);
      const std::string_view name = path.substr(0, path.find_first_of(".["));
      const toml::table* table = node->as_table();
      node = table != nullptr ? table->get(name) : nullptr;
      path.remove_prefix(name.size());
    }
  }
  return node;
}

const toml::node* nearest_node(const toml::table& root, std::string_view key) {
  for (;;) {
    if (const toml::node* node = find_node(root, key)) return node;
    const std::size_t end = key.find_last_of(".[");
    if (end == std::string_view::npos) return nullptr;
    key = key.substr(0, end);
  }
}

bool put(toml::node& node, std::string_view path, const toml::node& value) {
  toml::node* below = nullptr;
  if (path.starts_with('[')) {
    const std::optional<std::size_t> index = take_index(path);
    toml::array* array = node.as_array();
    if (!index || array == nullptr || *index >= array->size()) return false;
    if (path.empty()) {
      array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*index), value);
      return true;
    }
    below = array->get(*index);
  } else {
    const std::string_view name = path.substr(0, path.find_first_of(".["));
    toml::table* table = node.as_table();
    if (name.empty() || table == nullptr) return false;
    path.remove_prefix(name.size());
    if (path.empty()) {
      table->insert_or_assign(name, value);
      return true;
    }
    if (path.front() == '.') table->insert(name, toml::table{});  // unless it is there
    below = table->get(name);
  }
  if (path.front() == '.') path.remove_prefix(1);
  return below != nullptr && !path.empty() && put(*below, path, value);
}

std::string value_text(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  return {};
}

std::optional<std::string> literal_of(const toml::node& node, std::string& place) {
  if (const auto* text = node.as_string()) return toml_quoted(text->get());
  const auto* real = node.as_floating_point();
  if (node.is_boolean() || node.is_integer() || (real != nullptr && std::isfinite(real->get())))
    return value_text(node);
  const toml::array* array = node.as_array();
  if (array == nullptr) return std::nullopt;
  std::string out = "[";
  const std::size_t length = place.size();
  for (std::size_t i = 0; i < array->size(); ++i) {
    fmt::format_to(std::back_inserter(place), "[{}]", i);
    const std::optional<std::string> entry = literal_of((*array)[i], place);
    if (!entry) return std::nullopt;
    place.resize(length);
    out += (i == 0 ? "" : ", ") + *entry;
  }
  return out + "]";
}

bool is_list_of_tables(const toml::array& array) {
  return !array.empty() && std::all_of(array.begin(), array.end(), [](const toml::node& n) { return n.is_table(); });
}

TextPlaces::TextPlaces(std::string_view text) : text_(text), lines_{0} {
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1)) {
    lines_.push_back(at + 1);
  }
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) lines_.front() = mark.size();
}

std::size_t TextPlaces::offset_of(const toml::source_position& place) const {
  if (place.line > lines_.size()) return text_.size();
  std::size_t at = lines_[std::max<std::size_t>(place.line, 1) - 1];
  for (toml::source_index column = 1; column < place.column && at < text_.size(); ++column) {
    ++at;
    while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0U) == 0x80U) ++at;
  }
  return at;
}

}  // namespace robomill::io
