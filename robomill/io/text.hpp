#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"

namespace robomill::io {

/// The number that the whole of text spells, without regard to the locale: also "+1", "1.0D-03", "1e-020", "nan" and
/// "inf". Too large a magnitude is ±inf, too small a one 0.
[[nodiscard]] ROBOMILL_API std::optional<double> parse_number(std::string_view text);

/// The nearest number of 15 significant digits, so that 418.87902 rad/s come out as 4000 rpm and not as
/// 4000.0000000000005.
[[nodiscard]] double round_15(double number);

[[nodiscard]] ROBOMILL_API std::string_view trimmed(std::string_view text);
[[nodiscard]] ROBOMILL_API std::string lowered(std::string_view text);

/// Whether a column of this name is the time in seconds: "time_s", "t", "Time [s]", ….
[[nodiscard]] bool is_time_column(std::string_view name);

/// A header longer than this is no header.
inline constexpr std::size_t max_header_lines = 200;

/// The known word that a misspelt one is nearest to, or an empty string where none is near.
template <class Words>
[[nodiscard]] std::string nearest_word(std::string_view word, const Words& known);

/// Number of letters to insert, remove, replace or swap with a neighbour to turn one word into the other.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

template <class Words>
std::string nearest_word(std::string_view word, const Words& known) {
  std::string best;
  std::size_t least = word.size() / 3 + 2;
  for (const auto& candidate : known) {
    const std::size_t distance = edit_distance(lowered(word), lowered(candidate));
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace robomill::io
