#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::io {

/// What one axis of a function holds (records 8 to 10 of data set 58).
struct UffAxis {
  /// Specific data type: 8 displacement, 11 velocity, 12 acceleration, 13 force, 17 time, 18 frequency; 0 or 1 unsaid.
  int type = 0;
  int length_exponent = 0, force_exponent = 0;
  std::string label = "NONE", unit = "NONE";
};

/// One data set 58 or 58b: a function at a nodal degree of freedom.
struct UffFunction {
  int type = 0;  ///< 1 time response, 4 frequency response function, 6 coherence; 0 general
  std::array<std::string, 5> id = {"NONE", "NONE", "NONE", "NONE", "NONE"};
  int response_node = 0, response_direction = 0;    ///< direction ±1 … ±6: x y z, rotations; 0 unsaid
  int reference_node = 0, reference_direction = 0;  ///< as the response's
  bool is_complex = false;
  Eigen::VectorXd abscissa;  ///< length n
  Eigen::VectorXcd values;   ///< length n; imaginary parts are 0 unless is_complex
  UffAxis abscissa_axis, numerator, denominator;
  /// Data set 164 in force: file units / SI units of length and force.
  double length_factor = 1.0, force_factor = 1.0;
  bool has_units = false;  ///< such a data set stands before it
  std::size_t line = 0;    ///< of its data set, from 1
};

struct UffFile {
  std::vector<UffFunction> functions;
  std::vector<std::string> notes;  ///< data sets skipped, counts and line endings that were wrong
};

/// Reads universal data sets 58, 58b and 164; notes the others. Survives what writers get wrong: line endings of any
/// kind and mix, a missing last "-1", glued fixed-width numbers, D exponents and exponents without a letter, text that
/// is not ASCII, half-filled last lines, wrong byte counts, an abscissa in single or double precision.
/// @param where  names the file in messages
/// @throws InvalidInput with file and line if a header record or a number cannot be read, or the file ends within the
///     data
/// Source: [SDRC58], [SDRC164]
[[nodiscard]] UffFile parse_uff(std::string_view content, const std::string& where);

using UffTake = std::function<void(UffFunction&&)>;
/// The same, a function at a time. @returns the notes
[[nodiscard]] std::vector<std::string> read_uff(std::string_view content, const std::string& where,
                                                const UffTake& take);

/// Data set 164 with SI units, then data sets 58 (numbers as E20.12) or 58b (little-endian doubles). An abscissa is
/// written as first value and step where these, in the 12 characters that they have, give it back to a millionth of the
/// step (58b: a billionth).
[[nodiscard]] std::string format_uff(const std::vector<UffFunction>& functions, bool binary);

}  // namespace robomill::io
