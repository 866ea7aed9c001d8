#pragma once
#include <string>
#include <string_view>

namespace robomill::io {

/// What a person is asked for, in the unit that keys of files have.
enum class ShopQuantity {
  number,                    ///< without a unit
  length,                    ///< mm
  angle,                     ///< deg
  spindle_speed,             ///< rpm
  torque,                    ///< N m
  power,                     ///< kW
  force_sensitivity,         ///< mV/N
  acceleration_sensitivity,  ///< mV/g
  mass                       ///< kg
};

/// "mm"; empty of a number.
[[nodiscard]] std::string_view unit_of(ShopQuantity quantity);

/// A quantity as people write it: "0.25 in", "1/4\"", "12", "0,5 mm", "7.5 kW", "10 ft lbf", "100 mV/(m/s²)".
/// @param plain_unit  what a number alone is in; empty: that of unit_of()
/// @return in the unit of unit_of()
/// @throws InvalidInput saying what it is not, with the units that are known; "16,000", which has two meanings
[[nodiscard]] double parse_quantity(std::string_view text, ShopQuantity quantity, std::string_view plain_unit = {});

/// A value as a file has it, with six digits at most.
[[nodiscard]] std::string quantity_text(double value);

}  // namespace robomill::io
