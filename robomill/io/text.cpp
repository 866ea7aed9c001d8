#include "robomill/io/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "robomill/io/system/append.hpp"

namespace robomill::io {
namespace {

/// What from_chars calls out of range: too large or too small, as the exponent's sign shows (or, without one, the
/// integer part).
double beyond_range(std::string_view text) {
  const bool negative = text.front() == '-';
  const std::size_t exponent = text.find_first_of("eE");
  bool tiny = exponent != std::string_view::npos && exponent + 1 < text.size() && text[exponent + 1] == '-';
  if (exponent == std::string_view::npos) {
    const std::string_view digits = text.substr(negative ? 1 : 0);
    tiny = digits.find_first_not_of('0') == digits.find('.');
  }
  const double magnitude = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return negative ? -magnitude : magnitude;
}

std::optional<double> from_chars(std::string_view text) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, number);
  if (read.ptr != end || read.ec == std::errc::invalid_argument) return std::nullopt;
  return read.ec == std::errc::result_out_of_range ? beyond_range(text) : number;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  if (text.empty()) return std::nullopt;
  if (text.front() == '+') {
    text.remove_prefix(1);
    if (text.empty() || text.front() == '-' || text.front() == '+') return std::nullopt;
  }
  if (const std::optional<double> number = from_chars(text)) return number;
  const std::size_t letter = text.find_first_of("dDqQ");
  if (letter == std::string_view::npos || letter == 0 || text.size() > 64) return std::nullopt;
  std::string with_e(text);
  with_e[letter] = 'e';
  return from_chars(with_e);
}

double round_15(double number) {
  if (!std::isfinite(number)) return number;
  std::array<char, 40> digits = {};
  const auto end = fmt::format_to_n(digits.data(), digits.size(), "{:.14e}", number).out;
  double rounded = number;
  std::from_chars(digits.data(), end, rounded);
  return rounded;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\f\v";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return result;
}

bool is_time_column(std::string_view name) {
  const std::string word = lowered(name);
  constexpr std::string_view known[] = {"time_s", "time", "t", "time (s)", "time [s]", "t_s", "t (s)", "t [s]"};
  return std::ranges::find(known, word) != std::end(known);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

void append_formatted(std::string& text, fmt::string_view format, fmt::format_args args) {
  fmt::vformat_to(std::back_inserter(text), format, args);
}

void append_formatted(fmt::memory_buffer& text, fmt::string_view format, fmt::format_args args) {
  fmt::vformat_to(fmt::appender(text), format, args);
}

}  // namespace robomill::io
