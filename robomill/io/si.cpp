#include "robomill/io/si.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

struct Unit {
  std::string_view text;
  Quantity quantity;
  double factor;
};

constexpr std::array<Unit, 42> units = {{{"m", Quantity::displacement, 1.0},
                                         {"mm", Quantity::displacement, 1e-3},
                                         {"um", Quantity::displacement, 1e-6},
                                         {"in", Quantity::displacement, units::inch},
                                         {"rad", Quantity::displacement, 1.0},
                                         {"mrad", Quantity::displacement, 1e-3},
                                         {"urad", Quantity::displacement, 1e-6},
                                         {"m/s", Quantity::velocity, 1.0},
                                         {"mm/s", Quantity::velocity, 1e-3},
                                         {"um/s", Quantity::velocity, 1e-6},
                                         {"in/s", Quantity::velocity, units::inch},
                                         {"rad/s", Quantity::velocity, 1.0},
                                         {"m/s2", Quantity::acceleration, 1.0},
                                         {"m/s/s", Quantity::acceleration, 1.0},
                                         {"m/ss", Quantity::acceleration, 1.0},
                                         {"ms-2", Quantity::acceleration, 1.0},
                                         {"mm/s2", Quantity::acceleration, 1e-3},
                                         {"mm/s/s", Quantity::acceleration, 1e-3},
                                         {"mm/ss", Quantity::acceleration, 1e-3},
                                         {"um/s2", Quantity::acceleration, 1e-6},
                                         {"in/s2", Quantity::acceleration, units::inch},
                                         {"g", Quantity::acceleration, units::standard_gravity},
                                         {"gn", Quantity::acceleration, units::standard_gravity},
                                         {"rad/s2", Quantity::acceleration, 1.0},
                                         {"rad/s/s", Quantity::acceleration, 1.0},
                                         {"n", Quantity::force, 1.0},
                                         {"newton", Quantity::force, 1.0},
                                         {"newtons", Quantity::force, 1.0},
                                         {"kgf", Quantity::force, units::standard_gravity},
                                         {"pounds", Quantity::force, units::pound_force},
                                         {"kn", Quantity::force, 1e3},
                                         {"lbf", Quantity::force, units::pound_force},
                                         {"lb", Quantity::force, units::pound_force},
                                         {"nm", Quantity::force, 1.0},
                                         {"n-m", Quantity::force, 1.0},
                                         {"nmm", Quantity::force, 1e-3},
                                         {"meter", Quantity::displacement, 1.0},
                                         {"metre", Quantity::displacement, 1.0},
                                         {"meters", Quantity::displacement, 1.0},
                                         {"metres", Quantity::displacement, 1.0},
                                         {"inches", Quantity::displacement, units::inch},
                                         {"g's", Quantity::acceleration, units::standard_gravity}}};

/// Lower case, without blanks, brackets and signs of multiplication or power; ² is 2 and µ is u, in UTF-8 and Latin-1.
std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte == 0xC2 || byte == 0xB7) continue;  // the first leads ², µ and · in UTF-8; the second is ·
    if (byte == 0xCE && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) == 0xBC) {
      out += 'u';  // the Greek letter
      ++i;
    } else if (byte == 0xB2) {
      out += '2';
    } else if (byte == 0xB5) {
      out += 'u';
    } else if (std::string_view(" \t()[]^*.").find(text[i]) == std::string_view::npos) {
      out += static_cast<char>(std::tolower(byte));
    }
  }
  return out;
}

SiFactor find(std::string_view text) {
  for (const Unit& unit : units) {
    if (text == unit.text) return {.quantity = unit.quantity, .factor = unit.factor};
  }
  return {};
}

template <std::size_t n>
double factor_in(const std::array<std::pair<std::string_view, double>, n>& known, std::string_view text) {
  const std::string unit = plain(text);
  const auto* const found = std::ranges::find(known, unit, &std::pair<std::string_view, double>::first);
  return found == known.end() ? 0.0 : found->second;
}

bool says_nothing(std::string_view text) {
  return text.empty() || text == "none" || text == "-" || text == "unknown";
}

Quantity quantity_of_type(int type) {
  switch (type) {
    case 8:
      return Quantity::displacement;
    case 11:
      return Quantity::velocity;
    case 12:
      return Quantity::acceleration;
    case 9:
    case 13:
      return Quantity::force;
    default:
      return Quantity::unknown;
  }
}

}  // namespace

SiFactor parse_unit(std::string_view text) {
  const std::string unit = plain(text);
  if (SiFactor whole = find(unit); whole.quantity != Quantity::unknown) return whole;
  // A ratio to a force: "m/s2/n" or "1/n m/s2".
  for (const Unit& force : units) {
    if (force.quantity != Quantity::force) continue;
    const std::string below = fmt::format("/{}", force.text);
    std::string_view numerator;
    if (unit.ends_with(below)) numerator = std::string_view(unit).substr(0, unit.size() - below.size());
    if (unit.starts_with(fmt::format("1{}", below))) numerator = std::string_view(unit).substr(1 + below.size());
    if (numerator.empty()) continue;
    SiFactor ratio = find(numerator);
    if (ratio.quantity == Quantity::unknown) continue;
    ratio.factor /= force.factor;
    ratio.is_ratio = true;
    return ratio;
  }
  return {};
}

double seconds_in(std::string_view unit) {
  return factor_in<5>({{{"s", 1.0}, {"sec", 1.0}, {"seconds", 1.0}, {"ms", 1e-3}, {"us", 1e-6}}}, unit);
}

double volts_in(std::string_view unit) {
  return factor_in<5>({{{"v", 1.0}, {"volt", 1.0}, {"volts", 1.0}, {"mv", 1e-3}, {"millivolt", 1e-3}}}, unit);
}

bool is_unit(std::string_view text) {
  // What a column beside force and response may be in; the degree sign as plain() leaves it. A c right behind \xB0
  // would be read as one of its digits.
  static constexpr std::string_view others[] = {"-",   "%",     "ue",  "strain", "um/m",     "deg",  "\xB0",
                                                "rpm", "1/min", "hz",  "khz",    "\xB0\x63", "degc", "ma",
                                                "pa",  "kpa",   "mpa", "bar",    "kw",       "kg",   "min"};
  constexpr std::string_view epsilon = "\xCE\xB5";  // of strains, in UTF-8
  if (seconds_in(text) > 0.0 || volts_in(text) > 0.0 || text.find(epsilon) != std::string_view::npos) return true;
  return parse_unit(text).quantity != Quantity::unknown || std::ranges::find(others, plain(text)) != std::end(others);
}

std::string unit_of_column(std::string_view name) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    const std::size_t begin = name.rfind(open), end = name.rfind(close);
    if (begin != std::string_view::npos && end != std::string_view::npos && begin < end) {
      const std::string_view within = trimmed(name.substr(begin + 1, end - begin - 1));
      const bool is_place = within.find_first_not_of("0123456789:, ") == std::string_view::npos;  // x(:,1), s(2).y
      if (!is_place) return std::string(within);
    }
  }
  if (std::string unit = unit_of_key(lowered(name)); !unit.empty()) return unit;
  // "in" and "m" behind a blank are words and names too.
  static constexpr std::array<std::string_view, 8> sure = {"N", "kN", "g", "V", "mV", "s", "ms", "mm"};
  const std::string_view whole = trimmed(name);
  const std::size_t blank = whole.find_last_of(" \t");
  if (blank == std::string_view::npos) return {};
  const std::string_view last = whole.substr(blank + 1);
  const bool unit = std::ranges::find(sure, last) != sure.end() ||
                    (last.find('/') != std::string_view::npos && parse_unit(last).quantity != Quantity::unknown);
  return unit ? std::string(last) : std::string();
}

SiFactor si_factor(const UffAxis& axis, double length_factor, double force_factor) {
  const Quantity quantity = quantity_of_type(axis.type);
  SiFactor said = parse_unit(axis.unit);
  const bool agrees = quantity == Quantity::unknown || said.quantity == quantity;
  if (said.quantity != Quantity::unknown && agrees) {
    if (said.factor != 1.0) said.note = fmt::format("\"{}\" converted with {:.6g} to SI", axis.unit, said.factor);
    return said;
  }
  int length = axis.length_exponent, force = axis.force_exponent;
  if (length == 0 && force == 0) {
    length = quantity == Quantity::force || quantity == Quantity::unknown ? 0 : 1;
    force = quantity == Quantity::force ? 1 : 0;
  }
  SiFactor result{.quantity = quantity, .factor = std::pow(length_factor, -length) * std::pow(force_factor, -force)};
  if (!std::isfinite(result.factor) || result.factor == 0.0) result.factor = 1.0;
  if (result.factor != 1.0) {
    result.note = fmt::format("converted with {:.6g} to SI, as data set 164 says", result.factor);
  } else if (!says_nothing(plain(axis.unit))) {
    result.note = fmt::format("unit \"{}\" is not known here; values are taken as SI", axis.unit);
  }
  return result;
}

}  // namespace robomill::io
