#include "robomill/program/files/rewrite/calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/program/files/gcode/calls.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

constexpr std::string_view blanks = " \t";

bool is_call(const GcodeWords::Word& word) {
  return word.letter == 'm' && (word.number == 97.0 || word.number == 98.0);
}

bool line_may_call(std::string_view line, const std::string& file, GcodeWords& words) {
  try {
    words.scan(line, file, 0);
  } catch (const InvalidInput&) {
    return true;  // a part of a statement, or behind the program's end
  }
  if (const std::optional<OWord> control = o_word(words.compact())) return control->keyword == "call";
  return std::ranges::any_of(words.words(), is_call);
}

/// Letters as a comment.
std::string comment_of(std::string_view letters) {
  std::string out = "(";
  for (const char c : letters) out += c == '(' ? '[' : c == ')' ? ']' : c;
  return out + ")";
}

bool closes(std::string_view line) {
  const std::size_t first = line.find_first_not_of(blanks);
  return first != std::string_view::npos && line[first] == '%' &&
         line.find_first_not_of(blanks, first + 1) == std::string_view::npos;
}

class Expansion {
 public:
  Expansion(std::string_view text, const std::string& file, const ProgramReading& reading)
      : file_(file),
        lines_(lines_of(text)),
        reader_(file, reading, remarks_),
        calls_(file, [text, &file] { return ProgramLines(file, std::string(text)); }) {
    reader_.allow_calls();
    if (reading.tool.given() && GcodeReader::changes_tool_by_t(ProgramLines(file, std::string(text)), file)) {
      reader_.set_changes_tool_by_t();
    }
    if (text.starts_with(byte_order_mark)) out_.text = byte_order_mark;
  }

  ExpandedCalls run() {
    while (!reader_.ended()) {
      if (calls_.depth() > 0) {
        const GcodeCalls::Line called = calls_.next();
        reader_.go_on_at(called.number);
        take(called.number - 1, called.ahead);
      } else if (main_ < lines_.size()) {
        ++main_;
        take(main_ - 1, letter_ahead());
      } else {
        break;
      }
    }
    out_.passes = calls_.passes();
    if (out_.passes > 0) close();
    return std::move(out_);
  }

 private:
  struct RawLine {
    std::string_view text, end;
  };
  /// In place of bytes of a line.
  struct Edit {
    std::size_t begin = 0, end = 0;
    std::string text = {};
  };

  static std::vector<RawLine> lines_of(std::string_view text) {
    std::vector<RawLine> out;
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    while (!text.empty()) {
      const LineEnd end = line_end(text);
      out.push_back({.text = text.substr(0, end.at), .end = text.substr(end.at, end.bytes)});
      text.remove_prefix(end.at + end.bytes);
    }
    return out;
  }

  [[nodiscard]] char letter_ahead() const {
    if (main_ >= lines_.size()) return '\n';
    const std::string_view next = lines_[main_].text;
    const std::size_t at = next.find_first_not_of(blanks);
    return at == std::string_view::npos ? '\n' : next[at];
  }

  [[noreturn]] void reject(std::size_t index, std::string rule, const char* hint) const {
    throw InvalidInput(
        InvalidInput::Parts{.where = fmt::format("{}:{}", file_, index + 1), .rule = std::move(rule), .hint = hint});
  }

  void take(std::size_t index, char ahead) {
    const std::string_view line = lines_[index].text;
    const bool within = calls_.depth() > 0;
    const bool in_definition = reader_.leaves_out_sub();
    const bool continued = reader_.continued();
    reader_.take(line, ahead);
    Block block;
    while (reader_.pop(block)) {
    }
    if (in_definition || reader_.leaves_out_sub()) return;
    const bool controls = calls_.follow(reader_, main_ + 1);
    if (controls && continued) {
      reject(index, "calls or ends a subprogram in a statement over several lines, which cannot be expanded",
             "Write it on one line");
    }
    if (controls && out_.first == 0) out_.first = out_.origins.size() + 1;
    const bool whole = !continued && !reader_.continued();
    append(index, whole ? expanded(line, index, within, controls) : std::string(line));
  }

  void append(std::size_t index, std::string_view line) {
    constexpr std::size_t between_looks = 65'536;
    constexpr double bytes_a_line = 400.0;  // of what is known of a statement
    if (!ended_line_) out_.text += lines_.front().end.empty() ? "\n" : lines_.front().end;
    out_.text.append(line).append(lines_[index].end);
    ended_line_ = !lines_[index].end.empty();
    out_.origins.push_back(index + 1);
    if (out_.text.size() > GcodeCalls::most_bytes) {
      reject(index,
             fmt::format("lies beyond the first {} MB of the program with its calls of subprograms expanded, as a "
                         "decided program has them",
                         GcodeCalls::most_bytes >> 20U),
             "Let subprograms be repeated less often, or decide parts of the program");
    }
    if (out_.origins.size() % between_looks != 0) return;
    const auto count = static_cast<double>(out_.origins.size());
    require_affordable(
        {.bytes = bytes_a_line * count,
         .dominant = {.field = "the program with its calls expanded", .value = count, .unit = "lines and more"}});
  }

  /// The % behind the program's end.
  void close() {
    if (closes(lines_[main_ - 1].text)) return;
    for (std::size_t i = main_; i < lines_.size(); ++i) {
      if (!closes(lines_[i].text)) continue;
      append(i, lines_[i].text);
      return;
    }
  }

  /// A line of the program as it stands in the expanded one.
  std::string expanded(std::string_view line, std::size_t index, bool within, bool controls) {
    std::string out(line);
    if (!within && !controls && line.find('/') == std::string_view::npos) return out;
    words_.scan(line, file_, index + 1);
    const std::string_view compact = words_.compact();
    if (compact.empty()) return out;
    GcodeWords::find_letters(line, places_);
    edits_.clear();
    const bool o_line = compact.front() == 'o' && (within || controls);
    if (o_line || is_deleted_control(compact, within)) {
      edits_.push_back(comment(line, 0, compact.size()));
    } else {
      if (within) remove_number(line, compact);
      if (controls) remove_controls(line, within);
    }
    for (std::size_t i = edits_.size(); i-- > 0;) {
      const Edit& edit = edits_[i];
      out.replace(edit.begin, edit.end - edit.begin, edit.text);
    }
    return out;
  }

  /// Letters [first, last) of the compact line as a comment.
  [[nodiscard]] Edit comment(std::string_view line, std::size_t first, std::size_t last) const {
    Edit out = {.begin = places_[first], .end = places_[last - 1] + 1};
    out.text = comment_of(line.substr(out.begin, out.end - out.begin));
    return out;
  }

  static std::size_t behind_number(std::string_view compact) {
    std::size_t end = compact.front() == 'n' ? 1 : 0;
    while (end > 0 && end < compact.size() && is_digit(compact[end])) ++end;
    return end;
  }

  static bool is_deleted_control(std::string_view compact, bool within) {
    compact.remove_prefix(behind_number(compact));
    if (!compact.starts_with('/')) return false;
    compact.remove_prefix(1);
    while (!compact.empty() && is_digit(compact.front())) compact.remove_prefix(1);
    const auto says = [&](const char* code) { return compact.find(code) != std::string_view::npos; };
    return says("m97") || says("m98") || (within && says("m99")) || o_word(compact);
  }

  void remove_number(std::string_view line, std::string_view compact) {
    const std::size_t digits = behind_number(compact);
    if (digits < 2) return;
    const std::size_t behind = places_[digits - 1] + 1;
    const std::size_t next = line.find_first_not_of(blanks, behind);
    edits_.push_back({.begin = places_[0], .end = next == std::string_view::npos ? line.size() : next});
  }

  /// M98 P L and M99: the first of the words becomes a comment of them all.
  void remove_controls(std::string_view line, bool within) {
    std::size_t at = 0;
    std::string said;
    std::optional<std::size_t> commented;
    for (const GcodeWords::Word& word : words_.words()) {
      const std::size_t first = at;
      at += word.text.size();
      const bool returns = within && word.letter == 'm' && word.number == 99.0;
      if (!is_call(word) && !returns && word.letter != 'p' && word.letter != 'l') continue;
      Edit edit = {.begin = places_[first], .end = places_[at - 1] + 1};
      said.append(said.empty() ? "" : " ").append(line.substr(edit.begin, edit.end - edit.begin));
      if (commented) {
        while (edit.begin > 0 && blanks.find(line[edit.begin - 1]) != std::string_view::npos) --edit.begin;
      } else {
        commented = edits_.size();
      }
      edits_.push_back(edit);
    }
    if (commented) edits_[*commented].text = comment_of(said);
  }

  const std::string& file_;
  const std::vector<RawLine> lines_;
  ProgramRemarks remarks_{0};
  GcodeReader reader_;
  GcodeCalls calls_;
  std::size_t main_ = 0;  ///< lines of the main program that have been taken
  bool ended_line_ = true;
  GcodeWords words_;
  std::vector<std::size_t> places_;
  std::vector<Edit> edits_;
  ExpandedCalls out_;
};

}  // namespace

bool may_call(std::string_view text, const std::string& file) {
  GcodeWords words;
  const auto names = [](char c) { return c == 'm' || c == 'M' || c == 'o' || c == 'O'; };
  for (const auto* at = std::ranges::find_if(text, names); at != text.end();) {
    const auto place = static_cast<std::size_t>(at - text.begin());
    const std::size_t begin = text.find_last_of("\r\n", place) + 1;  // npos + 1 = 0
    const std::size_t end = std::min(text.find_first_of("\r\n", place), text.size());
    if (line_may_call(text.substr(begin, end - begin), file, words)) return true;
    at = std::find_if(text.begin() + end, text.end(), names);
  }
  return false;
}

ExpandedCalls expand_calls(std::string_view text, const std::string& file, const ProgramReading& reading) {
  return Expansion(text, file, reading).run();
}

InvalidInput at_origin(const InvalidInput& error, const std::string& file, const std::vector<std::size_t>& origins) {
  InvalidInput::Parts parts = error.parts();
  const std::string prefix = file + ":";
  if (!parts.where.starts_with(prefix)) return error;
  std::size_t line = 0;
  const char* const begin = parts.where.data() + prefix.size();
  std::from_chars(begin, parts.where.data() + parts.where.size(), line);
  if (line == 0 || line > origins.size()) return error;
  parts.where = prefix + std::to_string(std::max<std::size_t>(origins[line - 1], 1));
  return InvalidInput(std::move(parts));
}

}  // namespace robomill::program
