#include "robomill/io/si.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

namespace robomill::io {
namespace {

struct Unit {
  std::string_view text;
  Quantity quantity;
  double factor;
};

constexpr double standard_gravity_m_per_s2 = 9.80665;
constexpr double inch_m = 0.0254;
constexpr double pound_force_n = 4.4482216152605;

constexpr std::array<Unit, 36> units = {{{"m", Quantity::displacement, 1.0},
                                         {"mm", Quantity::displacement, 1e-3},
                                         {"um", Quantity::displacement, 1e-6},
                                         {"in", Quantity::displacement, inch_m},
                                         {"rad", Quantity::displacement, 1.0},
                                         {"mrad", Quantity::displacement, 1e-3},
                                         {"urad", Quantity::displacement, 1e-6},
                                         {"m/s", Quantity::velocity, 1.0},
                                         {"mm/s", Quantity::velocity, 1e-3},
                                         {"um/s", Quantity::velocity, 1e-6},
                                         {"in/s", Quantity::velocity, inch_m},
                                         {"rad/s", Quantity::velocity, 1.0},
                                         {"m/s2", Quantity::acceleration, 1.0},
                                         {"m/s/s", Quantity::acceleration, 1.0},
                                         {"m/ss", Quantity::acceleration, 1.0},
                                         {"ms-2", Quantity::acceleration, 1.0},
                                         {"mm/s2", Quantity::acceleration, 1e-3},
                                         {"mm/s/s", Quantity::acceleration, 1e-3},
                                         {"mm/ss", Quantity::acceleration, 1e-3},
                                         {"um/s2", Quantity::acceleration, 1e-6},
                                         {"in/s2", Quantity::acceleration, inch_m},
                                         {"g", Quantity::acceleration, standard_gravity_m_per_s2},
                                         {"gn", Quantity::acceleration, standard_gravity_m_per_s2},
                                         {"rad/s2", Quantity::acceleration, 1.0},
                                         {"rad/s/s", Quantity::acceleration, 1.0},
                                         {"n", Quantity::force, 1.0},
                                         {"newton", Quantity::force, 1.0},
                                         {"kn", Quantity::force, 1e3},
                                         {"lbf", Quantity::force, pound_force_n},
                                         {"lb", Quantity::force, pound_force_n},
                                         {"nm", Quantity::force, 1.0},
                                         {"n-m", Quantity::force, 1.0},
                                         {"nmm", Quantity::force, 1e-3},
                                         {"meter", Quantity::displacement, 1.0},
                                         {"metre", Quantity::displacement, 1.0},
                                         {"g's", Quantity::acceleration, standard_gravity_m_per_s2}}};

/// Lower case, without blanks, brackets and signs of multiplication or power; ² is 2 and µ is u, in UTF-8 and Latin-1.
std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte == 0xC2) continue;  // leads ² and µ in UTF-8
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
