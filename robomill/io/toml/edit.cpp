#include "robomill/io/toml/edit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/tree.hpp"

namespace robomill::io {
namespace {

/// Whether its keys stand on lines of their own, below a header.
bool has_header(const toml::node& node) {
  if (const toml::table* table = node.as_table()) return !table->is_inline();
  const toml::array* array = node.as_array();
  return array != nullptr && is_list_of_tables(*array) && has_header(*array->get(0));
}

/// Lines, from 1, that are the middle of a value.
void find_inner_lines(const toml::node& node, std::set<std::size_t>& lines) {
  if (!has_header(node)) {
    for (std::size_t line = node.source().begin.line + 1; line <= node.source().end.line; ++line) lines.insert(line);
    return;
  }
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, value] : *table) find_inner_lines(value, lines);
  } else {
    for (const toml::node& entry : *node.as_array()) find_inner_lines(entry, lines);
  }
}

/// The part after the last dot, and what stands before it.
struct KeyName {
  std::string_view table, last;
};
KeyName name_of(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string_view::npos) return {.table = {}, .last = key};
  return {.table = key.substr(0, dot), .last = key.substr(dot + 1)};
}

/// Whether a line without its # begins with this key and an equals sign.
bool sets(std::string_view line, std::string_view last) {
  line = trimmed(line);
  if (!line.starts_with(last)) return false;
  return trimmed(line.substr(last.size())).starts_with('=');
}

/// What a comment says, without its # and the blank after it; nothing where the line is none.
std::optional<std::string_view> comment_of(std::string_view line) {
  std::string_view text = trimmed(line);
  if (!text.starts_with('#')) return std::nullopt;
  text.remove_prefix(1);
  if (text.starts_with(' ')) text.remove_prefix(1);
  return text;
}

class Editor {
 public:
  Editor(std::string_view document, const TomlSetting& setting)
      : document_(document),
        setting_(setting),
        name_(name_of(setting.key)),
        root_(parse_toml(document, setting.key)),
        places_(document) {
    find_inner_lines(root_, inner_);
    for (std::size_t at = 0; at < document.size();) {
      const std::size_t end = std::min(document.find('\n', at), document.size() - 1) + 1;
      lines_.push_back(document.substr(at, end - at));
      at = end;
    }
  }

  /// The document by each way that there is; the first that sets the key counts.
  [[nodiscard]] std::vector<std::string> attempts() const {
    std::vector<std::string> out;
    const auto add = [&out](std::optional<std::string> text) {
      if (text) out.push_back(*std::move(text));
    };
    add(replaced());
    if (!out.empty()) return out;
    add(in_inline_table());
    add(out_of_comment());
    add(at_end_of_table());
    add(with_table_out_of_comment());
    out.push_back(with_new_table());
    return out;
  }

 private:
  [[nodiscard]] std::string line_of_key() const { return fmt::format("{} = {}\n", name_.last, setting_.value); }
  [[nodiscard]] std::string with(std::size_t begin, std::size_t end, std::string_view text) const {
    return fmt::format("{}{}{}", document_.substr(0, begin), text, document_.substr(end));
  }
  /// Line `index`, from 0, replaced; the document's size stands for one after the last.
  [[nodiscard]] std::string with_line(std::size_t index, std::string_view text, bool insert) const {
    const std::size_t begin =
        index < lines_.size() ? static_cast<std::size_t>(lines_[index].data() - document_.data()) : document_.size();
    const bool unended = begin == document_.size() && !document_.empty() && document_.back() != '\n';
    const std::size_t end = insert || index >= lines_.size() ? begin : begin + lines_[index].size();
    return with(begin, end, unended ? fmt::format("\n{}", text) : std::string(text));
  }

  [[nodiscard]] std::optional<std::string> replaced() const {
    const toml::node* node = find_node(root_, setting_.key);
    if (node == nullptr || has_header(*node)) return std::nullopt;
    return with(places_.offset_of(node->source().begin), places_.offset_of(node->source().end), setting_.value);
  }

  [[nodiscard]] std::optional<std::string> in_inline_table() const {
    const toml::node* node = find_node(root_, name_.table);
    if (node == nullptr || node->as_table() == nullptr || has_header(*node)) return std::nullopt;
    std::size_t end = places_.offset_of(node->source().end);
    if (end < 2 || document_[--end] != '}') return std::nullopt;
    const char* const before = node->as_table()->empty() ? " " : ", ";
    while (document_[end - 1] == ' ') --end;
    return with(end, end, fmt::format("{}{} = {}", before, name_.last, setting_.value));
  }

  /// The lines of the key's table, from the one after its header up to the next header.
  struct Section {
    std::size_t begin = 0, end = 0;
  };
  [[nodiscard]] std::optional<Section> section() const {
    const toml::node* node = find_node(root_, name_.table);
    if (node == nullptr || node->as_table() == nullptr || !has_header(*node)) return std::nullopt;
    Section out;
    if (!name_.table.empty()) out.begin = node->source().begin.line;
    for (out.end = out.begin; out.end < lines_.size() && !is_header(out.end);) ++out.end;
    return out;
  }
  [[nodiscard]] bool is_header(std::size_t index) const {
    if (inner_.contains(index + 1)) return false;
    const std::string_view line = trimmed(lines_[index]);
    const std::optional<std::string_view> comment = comment_of(line);
    return line.starts_with('[') || (comment && comment->starts_with('[') && trimmed(*comment).find(']') != line.npos);
  }

  [[nodiscard]] std::optional<std::string> out_of_comment() const {
    const std::optional<Section> lines = section();
    if (!lines) return std::nullopt;
    for (std::size_t i = lines->begin; i < lines->end; ++i) {
      const std::optional<std::string_view> comment = comment_of(lines_[i]);
      if (!comment || inner_.contains(i + 1) || !sets(*comment, name_.last)) continue;
      try {
        const std::string line = with_setting(*comment, {.key = std::string(name_.last), .value = setting_.value});
        return with_line(i, line + (lines_[i].ends_with('\n') ? "\n" : ""), false);
      } catch (const InvalidInput&) {
        // Prose that only looks like it.
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<std::string> at_end_of_table() const {
    const std::optional<Section> lines = section();
    if (!lines) return std::nullopt;
    std::size_t last = lines->end;
    while (last > lines->begin && !inner_.contains(last) &&
           (trimmed(lines_[last - 1]).empty() || comment_of(lines_[last - 1]))) {
      --last;
    }
    return with_line(last, line_of_key(), true);
  }

  [[nodiscard]] std::optional<std::string> with_table_out_of_comment() const {
    if (find_node(root_, name_.table) != nullptr) return std::nullopt;
    const std::string header = fmt::format("[{}]", name_.table);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const std::optional<std::string_view> comment = comment_of(lines_[i]);
      if (!comment || inner_.contains(i + 1) || !comment->starts_with(header)) continue;
      return with_setting(with_line(i, fmt::format("{}\n", trimmed(*comment)), false), setting_);
    }
    return std::nullopt;
  }

  [[nodiscard]] std::string with_new_table() const {
    const std::size_t open = name_.table.ends_with(']') ? name_.table.rfind('[') : std::string_view::npos;
    const bool list = open != std::string_view::npos;
    const std::string header =
        list ? fmt::format("[[{}]]", name_.table.substr(0, open)) : fmt::format("[{}]", name_.table);
    return with_line(lines_.size(), fmt::format("\n{}\n{}", header, line_of_key()), true);
  }

  std::string_view document_;
  const TomlSetting& setting_;
  KeyName name_;
  toml::table root_;
  TextPlaces places_;
  std::vector<std::string_view> lines_;  ///< each with its end
  std::set<std::size_t> inner_;
};

/// What a document has at a key, as toml++ writes it, so that it can be compared; nothing where it is no TOML, or has
/// no such key.
std::optional<std::string> value_in(const std::string& document, const std::string& key) {
  try {
    const toml::table root = parse_toml(document, key);
    const toml::node* node = find_node(root, key);
    if (node == nullptr) return std::nullopt;
    std::ostringstream out;
    node->visit([&out](const auto& value) { out << value; });
    return out.str();
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

}  // namespace

std::string toml_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      out += '\\';
      out += letter;
    } else if (static_cast<unsigned char>(letter) < 32 || letter == 127) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(letter)));
    } else {
      out += letter;
    }
  }
  return out + '"';
}

std::string toml_unquoted(std::string_view literal) {
  if (literal.size() < 2 || literal.front() != '"' || literal.back() != '"') return std::string(literal);
  if (literal.find('\\') == std::string_view::npos) return std::string(literal.substr(1, literal.size() - 2));
  const toml::table root = parse_toml("value = " + std::string(literal), "value");
  const auto* text = root.get("value")->as_string();
  return text != nullptr ? text->get() : std::string(literal);
}

std::optional<std::string> setting_of(std::string_view document, std::string_view key) {
  const toml::table root = parse_toml(document, std::string(key));
  const toml::node* node = find_node(root, key);
  if (node == nullptr || has_header(*node)) return std::nullopt;
  const TextPlaces places(document);
  const std::size_t begin = places.offset_of(node->source().begin);
  return std::string(document.substr(begin, places.offset_of(node->source().end) - begin));
}

std::string with_setting(std::string_view document, const TomlSetting& setting) {
  // A value alone, and not one with further keys in lines of their own.
  const std::optional<std::string> wanted =
      setting.value.find('\n') == std::string::npos ? value_in("value = " + setting.value, "value") : std::nullopt;
  const Editor editor(document, setting);
  if (wanted) {
    for (const std::string& text : editor.attempts()) {
      if (value_in(text, setting.key) == wanted) return text;
    }
  }
  throw InvalidInput(setting.key, wanted ? "cannot be set in this document" : "must be set to a value of TOML");
}

}  // namespace robomill::io
