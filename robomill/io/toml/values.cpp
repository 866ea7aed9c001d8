#include "robomill/io/toml/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robomill/io/text.hpp"
#include "robomill/io/toml/tree.hpp"

namespace robomill::io {
namespace {

/// The line that a place is in, without its end.
std::string_view line_at(std::string_view text, std::size_t at) {
  const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  return text.substr(begin, std::min(text.find('\n', at), text.size()) - begin);
}

std::string_view without_mark(std::string_view comment) {
  while (!comment.empty() && comment.front() == '#') comment.remove_prefix(1);
  return trimmed(comment);
}

constexpr toml::source_index longest_line = 10'000;  // characters, behind which no comment is sought
constexpr int most_comment_lines = 50;

/// What stands behind a value in its line; where nothing does, in the lines of comment right above it.
std::string comment_of(std::string_view text, const TextPlaces& places, const toml::source_region& region) {
  if (region.end.column > longest_line) return {};
  const std::size_t end = places.offset_of(region.end);
  const std::string_view rest = trimmed(text.substr(end, std::min(text.find('\n', end), text.size()) - end));
  if (rest.starts_with('#')) return std::string(without_mark(rest));
  std::string out;
  std::size_t begin = places.offset_of({region.begin.line, 1});
  for (int lines = 0; begin > 0 && lines < most_comment_lines; ++lines) {
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

class Collector {
 public:
  Collector(std::string_view text, std::size_t most) : text_(text), places_(text), most_(most) {}

  void collect(const toml::node& node, const std::string& key) {
    if (values.size() >= most_) return;
    if (std::optional<Json> value = plain(node)) {
      values.push_back({.key = key,
                        .value = std::move(*value),
                        .line = static_cast<int>(node.source().begin.line),
                        .comment = comment_of(text_, places_, node.source())});
      return;
    }
    if (const toml::table* table = node.as_table()) {
      for (const auto& [name, entry] : *table) {
        collect(entry, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()));
      }
    } else if (const toml::array* array = node.as_array()) {
      for (std::size_t i = 0; i < array->size(); ++i) collect((*array)[i], fmt::format("{}[{}]", key, i));
    }
  }

  std::vector<TomlValue> values = {};

 private:
  std::string_view text_;
  TextPlaces places_;
  std::size_t most_;
};

}  // namespace

std::vector<TomlValue> toml_values(std::string_view text, const std::string& file, std::size_t most) {
  const toml::table root = parse_toml(text, file);
  Collector collector(text, most);
  collector.collect(root, {});
  std::ranges::stable_sort(collector.values, {}, &TomlValue::line);
  return std::move(collector.values);
}

}  // namespace robomill::io
