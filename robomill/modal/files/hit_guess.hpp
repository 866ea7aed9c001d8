#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/records.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// Runs of letters and digits, in lower case.
[[nodiscard]] std::vector<std::string> words_in(std::string_view text);

/// What a column of a record seems to hold.
struct ColumnGuess {
  enum class Role { unknown, time, force, response, other };  ///< other: a count, or a second time
  std::string name = {};  ///< as hits.toml names it: its name, or its number from 1 where it has none of its own
  std::string unit = {};  ///< as its name or a row of units says it: "V", "m/s^2"; empty where they do not
  Role role = Role::unknown;
  std::string from = {};                           ///< what that is guessed from: "its name"; empty of unknown ones
  ResponseKind kind = ResponseKind::acceleration;  ///< of a response
  char axis = 0;                                   ///< 'x', 'y' or 'z'
  bool axis_said = false;                          ///< by its name
  double si_per_unit = 1;  ///< s, N or the SI unit of the kind are so many of what the column holds
  double volts = 0;        ///< a 1 of the column; 0: no voltage
};

/// Whether a unit is stated, known or not.
[[nodiscard]] bool states_unit(const ColumnGuess& column);

/// What the name and unit of a record's column say. @param place  from 0
[[nodiscard]] ColumnGuess guess_by_name(const io::Record& record, std::size_t place);

/// What the record of a hammer hit seems to hold.
struct HitGuess {
  std::vector<ColumnGuess> columns = {};  ///< one a column of the record
  std::string force_direction = "x";
  std::string direction_from = {};  ///< what that is guessed from; empty: nothing says it
  double sample_rate_hz = 0.0;      ///< 0: not known
  bool rounded_time = false;        ///< the column of time has too few digits to be read: the rate is that of all of it
  int hits = 1;                     ///< that the force has pulses of, far enough apart

  /// Places in `columns` of what has that role.
  [[nodiscard]] std::vector<std::size_t> with(ColumnGuess::Role role) const;
  /// Whether there are a force and a response.
  [[nodiscard]] bool is_hit() const;
};

/// Guesses by the names of columns ("force_n", "Hammer (N)", "acc x [g]"), their units, the name of the file
/// ("tap_y_2.csv") and, where names say nothing, by the signal: a time rises and never falls, rounded or not, a
/// hammer's force has the sharpest peak. A force is a hammer's where it is one short pulse, bounces aside, or several
/// of them as find_hit_segments parts them; that of a cut is not. Of responses of several kinds or units, or of one
/// direction twice, the first counts. Of records of anything else it finds no hit.
[[nodiscard]] HitGuess guess_hit(const io::Record& record);

}  // namespace robomill::modal
