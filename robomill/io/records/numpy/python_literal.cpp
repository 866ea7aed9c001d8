#include "robomill/io/records/numpy/python_literal.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <system_error>

namespace robomill::io {
namespace {

class PythonParser {
 public:
  explicit PythonParser(std::string_view text) : rest_(text) {}

  std::optional<PythonValue> whole() {
    PythonValue out;
    if (!value(out, 0)) return std::nullopt;
    skip_blanks();
    return rest_.empty() ? std::optional(std::move(out)) : std::nullopt;
  }

 private:
  static constexpr int deepest = 8;

  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }
  /// Whether the next letter is this one, which is then taken.
  bool take(char letter) {
    skip_blanks();
    if (!rest_.starts_with(letter)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool take_word(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  bool value(PythonValue& out, int depth) {
    skip_blanks();
    if (depth > deepest || rest_.empty()) return false;
    if (take('(')) return items(out, ')', depth);
    if (take('[')) return items(out, ']', depth);
    if (take('{')) return dictionary(out, depth);
    if (take_word("None")) return true;
    for (const auto& [word, number] : {std::pair{"True", 1}, {"False", 0}}) {
      if (!take_word(word)) continue;
      out.kind = PythonValue::Kind::boolean;
      out.number = number;
      return true;
    }
    const std::string_view before = rest_;
    if (take_word("b'") || take_word("u'")) rest_ = before.substr(1);
    if (rest_.front() == '\'' || rest_.front() == '"') return text(out);
    const std::from_chars_result read = std::from_chars(rest_.data(), rest_.data() + rest_.size(), out.number);
    if (read.ec != std::errc()) return false;
    rest_.remove_prefix(static_cast<std::size_t>(read.ptr - rest_.data()));
    take_word("L");  // of Python 2
    out.kind = PythonValue::Kind::whole;
    return true;
  }

  bool text(PythonValue& out) {
    const char quote = rest_.front();
    rest_.remove_prefix(1);
    out.kind = PythonValue::Kind::text;
    while (!rest_.empty() && rest_.front() != quote) {
      if (rest_.front() == '\\') rest_.remove_prefix(1);  // a quote or a stroke; others are no names of fields
      if (rest_.empty()) return false;
      out.text += rest_.front();
      rest_.remove_prefix(1);
    }
    return take(quote);
  }

  bool items(PythonValue& out, char close, int depth) {
    out.kind = PythonValue::Kind::list;
    while (!take(close)) {
      out.items.emplace_back();
      if (!value(out.items.back(), depth + 1)) return false;
      if (take(',')) continue;
      return take(close);
    }
    return true;
  }

  bool dictionary(PythonValue& out, int depth) {
    out.kind = PythonValue::Kind::dictionary;
    while (!take('}')) {
      PythonValue key;
      if (!value(key, depth + 1) || key.kind != PythonValue::Kind::text || !take(':')) return false;
      out.keys.push_back(std::move(key.text));
      out.items.emplace_back();
      if (!value(out.items.back(), depth + 1)) return false;
      if (take(',')) continue;
      return take('}');
    }
    return true;
  }

  std::string_view rest_;
};

}  // namespace

const PythonValue* PythonValue::get(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i] == key) return &items[i];
  }
  return nullptr;
}

std::optional<PythonValue> parse_python(std::string_view text) {
  return PythonParser(text).whole();
}

}  // namespace robomill::io
