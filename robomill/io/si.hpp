#pragma once
#include <string>
#include <string_view>

#include "robomill/io/records/uff.hpp"

namespace robomill::io {

/// What a physical axis holds; for displacement, velocity and acceleration the value is the number of time derivatives.
enum class Quantity : int { displacement = 0, velocity = 1, acceleration = 2, force = 3, unknown = 4 };

/// How values become SI: SI value = factor * value.
struct SiFactor {
  Quantity quantity = Quantity::unknown;
  double factor = 1.0;
  bool is_ratio = false;  ///< the unit is one per force: "m/s²/N"
  std::string note = {};  ///< what was converted or assumed, where that is worth saying
};

/// What a unit's text says: "m/s^2", "mm/s²", "g", "N", "(1/N)*(m/s²)" (then the quantity and factor of the numerator).
/// Unknown where the text is no unit known here.
[[nodiscard]] SiFactor parse_unit(std::string_view text);

/// Seconds in a unit of time, "ms"; volts in one of voltage, "mV"; 0 where the text is none.
[[nodiscard]] double seconds_in(std::string_view unit);
[[nodiscard]] double volts_in(std::string_view unit);

/// Whether a text is a unit, of whatever quantity: "N", "m/s²", "ms", "mV", "µε", "rpm", "-".
[[nodiscard]] bool is_unit(std::string_view text);

/// The unit that a column's name states: what stands in brackets at its end, else the unit of its last parts, else its
/// last word where that is a unit and not likely a word: "acc x [m/s²]", "ax_m_per_s2", "Force N". Empty: none.
[[nodiscard]] std::string unit_of_column(std::string_view name);

/// An axis of a universal file: by its unit's text, else by data set 164, else taken as SI. The quantity is that of its
/// data type, or of its unit's text where the type says nothing.
[[nodiscard]] SiFactor si_factor(const UffAxis& axis, double length_factor, double force_factor);

}  // namespace robomill::io
