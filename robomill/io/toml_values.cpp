#include "robomill/io/toml_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robomill/io/toml_tree.hpp"

namespace robomill::io {
namespace {

/// The line that a place is in, without its end.
std::string_view line_at(std::string_view text, std::size_t at) {
  const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  return text.substr(begin, std::min(text.find('\n', at), text.size()) - begin);
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::string_view without_mark(std::string_view comment) {
  while (!comment.empty() && comment.front() == '#') comment.remove_prefix(1);
  return trimmed(comment);
}

/// What stands behind a value in its line; where nothing does, in the lines of comment right above it.
std::string comment_of(std::string_view text, const toml::source_region& region) {
  const std::size_t end = offset_of(text, region.end);
  const std::string_view rest = trimmed(text.substr(end, std::min(text.find('\n', end), text.size()) - end));
  if (rest.starts_with('#')) return std::string(without_mark(rest));
  std::string out;
  std::size_t begin = offset_of(text, {region.begin.line, 1});
  while (begin > 0) {
    const std::string_view above = trimmed(line_at(text, begin - 1));
    if (!above.starts_with('#')) break;
    out = std::string(without_mark(above)) + (out.empty() ? "" : " ") + out;
    begin -= std::min(begin, line_at(text, begin - 1).size() + 1);
  }
  return out;
}

/// A plain value; none for tables, lists of tables, dates.
std::optional<Json> plain(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return Json(whole->get());
  if (const auto* real = node.as_floating_point())
    return std::isfinite(real->get()) ? Json(real->get()) : Json(nullptr);
  if (const auto* flag = node.as_boolean()) return Json(flag->get());
  if (const auto* text = node.as_string()) return Json(text->get());
  const auto* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  Json out = Json::array();
  for (const toml::node& entry : *list) {
    std::optional<Json> value = plain(entry);
    if (!value) return std::nullopt;
    out.push_back(std::move(*value));
  }
  return out;
}

void collect(std::string_view text, const toml::node& node, const std::string& key, std::vector<TomlValue>& out) {
  if (std::optional<Json> value = plain(node)) {
    out.push_back({.key = key,
                   .value = std::move(*value),
                   .line = static_cast<int>(node.source().begin.line),
                   .comment = comment_of(text, node.source())});
    return;
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, entry] : *table) {
      collect(text, entry, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()), out);
    }
  } else if (const toml::array* array = node.as_array()) {
    for (std::size_t i = 0; i < array->size(); ++i) collect(text, (*array)[i], fmt::format("{}[{}]", key, i), out);
  }
}

}  // namespace

std::vector<TomlValue> toml_values(std::string_view text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  std::vector<TomlValue> out;
  collect(text, root, {}, out);
  std::ranges::stable_sort(out, {}, &TomlValue::line);
  return out;
}

}  // namespace robomill::io
