#include "robomill/io/key_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "robomill/base/units.hpp"

namespace robomill::io {
namespace {

/// A word of a key that is a unit.
struct UnitWord {
  std::string_view word, symbol;
  std::string_view si = {};  ///< in the name of an SI member; empty: the word itself, whose factor is 1
  double factor = 1.0;
  double inverse = 0.0;  ///< of the factor, where that is a power of ten, whose division would round; 0: divide
};
constexpr double hour = 60.0 * units::minute;
constexpr UnitWord unit_words[] = {
    {"m", "m"},
    {"mm", "mm", "m", units::mm, 1e3},
    {"um", "um", "m", units::um, 1e6},
    {"m2", "m^2"},
    {"mm2", "mm^2", "m2", 1e-6, units::n_per_mm2},
    {"m3", "m^3"},
    {"mm3", "mm^3", "m3", units::mm3, units::n_per_mm3},
    {"s", "s"},
    {"ms", "ms", "s", units::ms, 1e3},
    {"us", "us", "s", units::us, 1e6},
    {"s2", "s^2"},
    {"s3", "s^3"},
    {"min", "min", "s", units::minute},
    {"hour", "h", "s", hour},
    {"h", "h", "s", hour},
    {"hz", "Hz"},
    {"khz", "kHz", "hz", 1e3},
    {"rpm", "rpm", "rad_per_s", units::rpm},
    {"rad", "rad"},
    {"deg", "deg", "rad", units::deg},
    {"n", "N"},
    {"kn", "kN", "n", 1e3},
    {"kg", "kg"},
    {"g", "g"},
    {"pa", "Pa"},
    {"mpa", "MPa", "pa", 1e6},
    {"gpa", "GPa", "pa", units::gpa},
    {"w", "W"},
    {"kw", "kW", "w", units::kw},
    {"mv", "mV"},  // of sensitivities, which stay per mV
    {"v", "V"},
};

const UnitWord* unit_word(std::string_view word) {
  const auto* const found = std::ranges::find(unit_words, word, &UnitWord::word);
  return found == std::end(unit_words) ? nullptr : found;
}

/// The unit at the end of a key, above and below each "per"; null stands for a "per".
struct Suffix {
  std::string_view name = {};  ///< of the key, before its unit
  std::vector<const UnitWord*> words = {};
};

Suffix suffix_of(std::string_view key) {
  if (const std::size_t dot = key.rfind('.'); dot != std::string_view::npos) key.remove_prefix(dot + 1);
  Suffix out{.name = key.substr(0, key.find('['))};
  for (;;) {
    const std::size_t bar = out.name.rfind('_');
    if (bar == std::string_view::npos) break;
    const std::string_view token = out.name.substr(bar + 1);
    const UnitWord* const word = unit_word(token);
    if (token != "per" && word == nullptr) break;
    out.words.push_back(word);
    out.name = out.name.substr(0, bar);
  }
  std::ranges::reverse(out.words);
  return out;
}

std::string text_of(const Suffix& suffix) {
  std::string above, below;
  bool divided = false;
  int fractions = 0;
  for (const UnitWord* const word : suffix.words) {
    std::string& part = divided ? below : above;
    if (word == nullptr) {
      if (divided) part += '/';
      divided = true;
      ++fractions;
      continue;
    }
    if (!part.empty() && part.back() != '/') part += ' ';
    part += word->symbol;
  }
  if (below.empty()) return above;
  const bool compound = fractions > 1 || below.find(' ') != std::string::npos;
  if (compound) below = fmt::format("({})", below);
  return fmt::format("{}/{}", above.empty() ? "1" : above, below);
}

/// "rad_per_s_per_s" is written rad_per_s2.
std::string squared_time(std::string member) {
  constexpr std::string_view twice = "_per_s_per_s";
  if (member.ends_with(twice)) member.replace(member.size() - twice.size(), twice.size(), "_per_s2");
  return member;
}

}  // namespace

std::string unit_of_key(std::string_view key) {
  return text_of(suffix_of(key));
}

KeyUnit key_unit(std::string_view key) {
  const Suffix suffix = suffix_of(key);
  KeyUnit out{.name = std::string(suffix.name), .text = text_of(suffix), .member = std::string(suffix.name)};
  bool divided = false;
  for (const UnitWord* const word : suffix.words) {
    if (word == nullptr) {
      divided = true;
      out.member += "_per";
      continue;
    }
    if (!divided) {
      out.factor *= word->factor;
    } else if (word->inverse > 0.0) {
      out.factor *= word->inverse;
    } else {
      out.factor /= word->factor;
    }
    out.member.append("_").append(word->si.empty() ? word->word : word->si);
  }
  out.member = squared_time(std::move(out.member));
  return out;
}

}  // namespace robomill::io
