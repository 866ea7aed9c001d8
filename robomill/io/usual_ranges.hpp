#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Method: robomill/io/README.md, "Usual ranges"

namespace robomill::io {

/// What of a key's value is compared with its range. Signs do not count, but of a number whose row says so: a key that
/// must not be negative is an error of its reader.
enum class Compared {
  each,     ///< every number of the value
  largest,  ///< of a list its largest number: a vector may have small components
  angles,   ///< the same, and whether the numbers look like radians
  any       ///< nothing: there is no usual range
};

/// The usual values of a key, whichever document it stands in.
struct UsualRange {
  std::string_view key;  ///< its last part, "diameter_mm", or its whole path, "tool[].length_mm"
  double lowest, highest;
  Compared compared = Compared::each;
  std::string_view if_negative = {};  ///< the likely cause of one number below 0; empty where signs do not count
};

/// All rows.
[[nodiscard]] std::span<const UsualRange> usual_ranges();

/// The row of a key: that of its whole path before that of its last part; null where there is none.
/// @param key  "tool[0].length_mm": indices do not count
[[nodiscard]] const UsualRange* usual_range(std::string_view key);

/// What is unusual about a value.
struct Unusual {
  double value = 0.0;  ///< in the unit of the key
  std::string rule;    ///< "is unusual: 0.0001 to 2 mm is usual"
  std::string hint;    ///< "Is it in um?"; empty where no other unit explains it
};

/// Compares numbers other than 0 with the row of their key; the first that is outside it, none where all are usual or
/// no row is known. The hint names the first unit that would bring the value into the range.
[[nodiscard]] std::optional<Unusual> unusual_value(std::string_view key, std::span<const double> values);

/// The same as a sentence: "Warning: where: key = value unit; is unusual: … is usual. hint".
[[nodiscard]] std::optional<std::string> unusual_warning(std::string_view where, std::string_view key,
                                                         std::span<const double> values);

/// What a note that is a warning begins with.
inline constexpr std::string_view warning_label = "Warning: ";

/// Takes the warnings out of notes, without the label.
[[nodiscard]] std::vector<std::string> take_warnings(std::vector<std::string>& notes);

}  // namespace robomill::io
