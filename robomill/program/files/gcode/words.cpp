#include "robomill/program/files/gcode/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {
namespace {

struct Place {
  const std::string& file;
  std::size_t line;
};

[[noreturn]] void reject(const Place& place, std::string_view text, const char* rule, const char* hint = "") {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", place.file, place.line),
                                         .field = fmt::format("\"{}\"", printable(text, 24)),
                                         .rule = rule,
                                         .hint = hint});
}

bool is_letter(char c) {
  return c >= 'a' && c <= 'z';
}

/// Whether a line is left out by the machine's switch: a slash at its begin or behind its number.
bool is_deleted(std::string_view compact) {
  if (compact.starts_with('n')) {
    compact.remove_prefix(1);
    while (!compact.empty() && is_digit(compact.front())) compact.remove_prefix(1);
  }
  return compact.starts_with('/');
}

/// Hands over place and letter of what is no blank and no comment. Where a comment begins that does not end; the line's
/// length where all of them end.
template <class Take>
std::size_t each_letter(std::string_view line, Take take) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == ';') break;
    if (c == '(') {
      const std::size_t end = line.find(')', i);
      if (end == std::string_view::npos) return i;
      i = end;
    } else if (c != ' ' && c != '\t' && c != '\r' && c != '\f' && c != '\v') {
      take(i, c);
    }
  }
  return line.size();
}

/// Lower case, without blanks and comments.
void compact_letters(std::string_view line, const Place& place, std::string& out) {
  out.clear();
  const std::size_t end = each_letter(
      line, [&](std::size_t, char c) { out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (out.size() > 1 && out.front() == ':' && is_digit(out[1])) out.front() = 'o';  // a program's number in ISO code
  if (end != line.size()) reject(place, line.substr(end), "is a comment that does not end");
}

}  // namespace

std::optional<OWord> o_word(std::string_view compact) {
  constexpr std::array<std::string_view, 15> keywords = {"sub",      "endsub", "call",      "return", "if",
                                                         "elseif",   "else",   "endif",     "do",     "while",
                                                         "endwhile", "repeat", "endrepeat", "break",  "continue"};
  if (!compact.starts_with('o')) return std::nullopt;
  std::size_t end = 1;
  if (end < compact.size() && compact[end] == '<') {
    end = compact.find('>', end);
    if (end == std::string_view::npos) return std::nullopt;
    ++end;
  } else {
    while (end < compact.size() && is_digit(compact[end])) ++end;
    if (end == 1) return std::nullopt;
  }
  const std::size_t keyword = end;
  while (end < compact.size() && is_letter(compact[end])) ++end;
  const OWord out = {.label = compact.substr(1, keyword - 1),
                     .keyword = compact.substr(keyword, end - keyword),
                     .rest = compact.substr(end)};
  const bool known = std::ranges::find(keywords, out.keyword) != keywords.end();
  return known ? std::optional(out) : std::nullopt;
}

void GcodeWords::find_letters(std::string_view line, std::vector<std::size_t>& places) {
  places.clear();
  static_cast<void>(each_letter(line, [&](std::size_t place, char) { places.push_back(place); }));
}

std::string_view GcodeWords::compact_line(std::string_view line, const std::string& file, std::size_t number) {
  words_.clear();
  compact_letters(line, {.file = file, .line = number}, compact_);
  return compact_;
}

void GcodeWords::scan(std::string_view line, const std::string& file, std::size_t number) {
  const Place place = {.file = file, .line = number};
  compact_line(line, file, number);
  if (compact_.empty() || compact_.front() == '%' || compact_.front() == '$' || is_deleted(compact_)) return;
  if (o_word(compact_)) return;
  const char* at = compact_.data();
  const char* const end = at + compact_.size();
  while (at != end) {
    const std::string_view rest(at, static_cast<std::size_t>(end - at));
    if (*at == '#' || *at == '[' || *at == '=') {
      reject(place, rest, "is a parameter or an expression, which are not read here",
             "Let the CAM system write numbers");
    }
    const bool corner = *at == ',';
    if (corner && !(rest.size() > 1 && (rest[1] == 'r' || rest[1] == 'c'))) {
      reject(place, rest, "is a word of drawings (angles, bends) that is not read here",
             "Let the CAM system write straight moves and arcs; corners may be ,R and ,C");
    }
    if (!corner && !is_letter(*at)) reject(place, rest, "must begin with a letter: words are a letter and a number");
    const char* digits = at + (corner ? 2 : 1);
    if (digits != end && *digits == '+') ++digits;
    // from_chars would take "inf", "nan" and a second sign.
    const char* const first = digits != end && *digits == '-' && *(digits - 1) != '+' ? digits + 1 : digits;
    if (first == end || !((*first >= '0' && *first <= '9') || *first == '.')) {
      reject(place, rest,
             *at == 'o' ? "is a subroutine or its control, which are not read here" : "must be a letter and a number",
             *at == 'o' ? "Let the CAM system write the program out" : "Parameters and expressions are not read here");
    }
    Word word = {.letter = *at, .number = 0.0, .text = {}};
    const std::from_chars_result read = std::from_chars(digits, end, word.number, std::chars_format::fixed);
    if (read.ec != std::errc{}) reject(place, rest, "must be a letter and a number that a double can hold");
    word.text = std::string_view(at, static_cast<std::size_t>(read.ptr - at));
    words_.push_back(word);
    at = read.ptr;
  }
}

}  // namespace robomill::program
