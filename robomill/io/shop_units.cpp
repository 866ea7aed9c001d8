#include "robomill/io/shop_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr double foot_m = 12.0 * units::inch;
constexpr double metric_horsepower = 75.0 * units::standard_gravity;

/// A name as squeezed() leaves it, and its size in the unit of the quantity's keys. The first of a quantity is that
/// unit.
struct ShopUnit {
  ShopQuantity quantity;
  std::string_view name, shown;
  double factor;
};
constexpr ShopUnit shop_units[] = {
    {ShopQuantity::length, "mm", "mm", 1.0},
    {ShopQuantity::length, "in", "in", units::inch / units::mm},
    {ShopQuantity::length, "inch", "", units::inch / units::mm},
    {ShopQuantity::length, "inches", "", units::inch / units::mm},
    {ShopQuantity::length, "\"", "", units::inch / units::mm},
    {ShopQuantity::length, "thou", "thou", 1e-3 * units::inch / units::mm},
    {ShopQuantity::length, "um", "um", units::um / units::mm},
    {ShopQuantity::length, "cm", "cm", 10.0},
    {ShopQuantity::length, "m", "m", 1.0 / units::mm},
    {ShopQuantity::angle, "deg", "deg", 1.0},
    {ShopQuantity::angle, "degrees", "", 1.0},
    {ShopQuantity::angle, "°", "", 1.0},
    {ShopQuantity::angle, "rad", "rad", 1.0 / units::deg},
    {ShopQuantity::spindle_speed, "rpm", "rpm", 1.0},
    {ShopQuantity::spindle_speed, "1/min", "1/min", 1.0},
    {ShopQuantity::spindle_speed, "min-1", "", 1.0},
    {ShopQuantity::spindle_speed, "u/min", "", 1.0},
    {ShopQuantity::spindle_speed, "hz", "Hz", 60.0},
    {ShopQuantity::torque, "nm", "Nm", 1.0},
    {ShopQuantity::torque, "ncm", "Ncm", 0.01},
    {ShopQuantity::torque, "ftlbf", "ft lbf", foot_m* units::pound_force},
    {ShopQuantity::torque, "ftlb", "", foot_m* units::pound_force},
    {ShopQuantity::torque, "lbft", "", foot_m* units::pound_force},
    {ShopQuantity::torque, "inlbf", "in lbf", units::inch* units::pound_force},
    {ShopQuantity::torque, "inlb", "", units::inch* units::pound_force},
    {ShopQuantity::power, "kw", "kW", 1.0},
    {ShopQuantity::power, "w", "W", 1.0 / units::kw},
    {ShopQuantity::power, "hp", "hp", units::horsepower / units::kw},
    {ShopQuantity::power, "ps", "PS", metric_horsepower / units::kw},
    {ShopQuantity::force_sensitivity, "mv/n", "mV/N", 1.0},
    {ShopQuantity::force_sensitivity, "v/n", "V/N", 1e3},
    {ShopQuantity::force_sensitivity, "mv/kn", "mV/kN", 1e-3},
    {ShopQuantity::force_sensitivity, "mv/lbf", "mV/lbf", 1.0 / units::pound_force},
    {ShopQuantity::force_sensitivity, "mv/lb", "", 1.0 / units::pound_force},
    {ShopQuantity::acceleration_sensitivity, "mv/g", "mV/g", 1.0},
    {ShopQuantity::acceleration_sensitivity, "v/g", "V/g", 1e3},
    {ShopQuantity::acceleration_sensitivity, "mv/m/s2", "mV/(m/s2)", units::standard_gravity},
    {ShopQuantity::acceleration_sensitivity, "mv/ms-2", "", units::standard_gravity},
    {ShopQuantity::mass, "kg", "kg", 1.0},
    {ShopQuantity::mass, "g", "g", 1e-3},
    {ShopQuantity::mass, "lb", "lb", units::pound_force / units::standard_gravity},
};

/// Lower case, without blanks, brackets, points and signs of multiplication or power; ² is 2 and µ is u.
std::string squeezed(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("²")) out += '2';
    if (rest.starts_with("µ") || rest.starts_with("μ")) out += 'u';
    if (rest.starts_with("°")) out += "°";
    if (static_cast<unsigned char>(text[i]) >= 0x80) continue;
    if (std::string_view(" \t().*^").find(text[i]) != std::string_view::npos) continue;
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
  }
  return out;
}

std::string_view article_and_name(ShopQuantity quantity) {
  switch (quantity) {
    case ShopQuantity::length:
      return "a length";
    case ShopQuantity::angle:
      return "an angle";
    case ShopQuantity::spindle_speed:
      return "a spindle speed";
    case ShopQuantity::torque:
      return "a torque";
    case ShopQuantity::power:
      return "a power";
    case ShopQuantity::force_sensitivity:
      return "the sensitivity of a force sensor";
    case ShopQuantity::acceleration_sensitivity:
      return "the sensitivity of an accelerometer";
    case ShopQuantity::mass:
      return "a mass";
    case ShopQuantity::number:
      break;
  }
  return "a number";
}

/// "12", "0,5", "1/4", "1 1/4".
std::optional<double> number_in(std::string_view text) {
  text = trimmed(text);
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_cell(text);
  const std::size_t blank = text.find(' ');
  const bool mixed = blank < slash;
  const std::optional<double> whole = mixed ? parse_cell(text.substr(0, blank)) : 0.0;
  const std::optional<double> above = parse_cell(trimmed(text.substr(mixed ? blank : 0, slash - (mixed ? blank : 0))));
  const std::optional<double> below = parse_cell(trimmed(text.substr(slash + 1)));
  if (!whole || !above || !below || !(*below > 0.0)) return std::nullopt;
  return *whole + *above / *below;
}

/// "1,250" is 1250 to some and 1.25 to others. Other commas part decimals: "0,125", "7,5".
bool has_ambiguous_comma(std::string_view number) {
  if (number.starts_with('-') || number.starts_with('+')) number.remove_prefix(1);
  const std::size_t comma = number.find(',');
  if (comma == std::string_view::npos || comma < 1 || comma > 3 || number.size() != comma + 4) return false;
  return number.front() != '0' &&
         std::ranges::all_of(number, [](unsigned char letter) { return letter == ',' || std::isdigit(letter) != 0; });
}

void require_clear_commas(std::string_view answer, std::string_view number) {
  while (!number.empty()) {
    const std::size_t end = std::min(number.find_first_of(" /"), number.size());
    const std::string part(number.substr(0, end));
    number.remove_prefix(std::min(end + 1, number.size()));
    if (!has_ambiguous_comma(part)) continue;
    const std::size_t comma = part.find(',');
    std::string decimals = part.substr(comma + 1);
    while (decimals.size() > 1 && decimals.ends_with('0')) decimals.pop_back();
    const std::string whole = part.substr(0, comma);
    throw InvalidInput(fmt::format("\"{}\"", answer), "may have a comma for thousands or one for decimals",
                       fmt::format("Write {}{} or {}.{}", whole, part.substr(comma + 1), whole, decimals));
  }
}

}  // namespace

std::string_view unit_of(ShopQuantity quantity) {
  for (const ShopUnit& unit : shop_units) {
    if (unit.quantity == quantity) return unit.shown;
  }
  return {};
}

double parse_quantity(std::string_view text, ShopQuantity quantity, std::string_view plain_unit) {
  text = trimmed(text);
  // The number reaches as far as one can be read; "1e3", "1/4" and "1/min" part so too.
  std::size_t end = text.size();
  std::optional<double> number;
  for (; end > 0 && !(number = number_in(text.substr(0, end))); --end) {
  }
  require_clear_commas(text, text.substr(0, end));
  std::string unit = squeezed(text.substr(end));
  if (unit.empty()) unit = plain_unit.empty() ? squeezed(unit_of(quantity)) : squeezed(plain_unit);
  std::string known;
  for (const ShopUnit& candidate : shop_units) {
    if (candidate.quantity != quantity) continue;
    if (number && std::isfinite(*number) && candidate.name == unit) return *number * candidate.factor;
    if (!candidate.shown.empty()) known += fmt::format("{}{}", known.empty() ? "" : ", ", candidate.shown);
  }
  if (quantity == ShopQuantity::number && number && std::isfinite(*number) && unit.empty()) return *number;
  throw InvalidInput(fmt::format("\"{}\"", text), fmt::format("is not {}", article_and_name(quantity)),
                     known.empty() ? "" : fmt::format("A number with one of {}, or alone", known));
}

std::string quantity_text(double value) {
  return fmt::format("{:.6g}", value);
}

}  // namespace robomill::io
