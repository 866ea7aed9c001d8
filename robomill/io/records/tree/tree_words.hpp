#pragma once
// What the values of a file of named values are called.
#include <string>
#include <string_view>

namespace robomill::io {

/// Lower case, letters and digits alone: "sample_rate [Hz]" is "sampleratehz".
[[nodiscard]] std::string plain_word(std::string_view key);

/// What a number of this name says of the rate.
struct RateWord {
  enum class Kind { none, rate, step };
  Kind kind = Kind::none;
  double factor = 1.0;  ///< Hz or s in its unit
};
/// fs, sample_rate, sampling_frequency, rate, …; dt, sample_interval, Ts, increment, …; with Hz, kHz, s, ms or us.
[[nodiscard]] RateWord rate_word(std::string_view key);

/// Seconds in a value of times of this name: "time", "t", "time_ms"; 0: it is none.
[[nodiscard]] double time_word(std::string_view key);

/// Whether what stands beside a value of this name is said of it: "values", "data", "y".
[[nodiscard]] bool is_values_word(std::string_view key);
/// Texts that state units, names of several columns, or the name of one.
[[nodiscard]] bool is_unit_word(std::string_view key);
[[nodiscard]] bool is_names_word(std::string_view key);
[[nodiscard]] bool is_label_word(std::string_view key);
/// Numbers that values may yet have to be multiplied with: "sensitivity", "scale".
[[nodiscard]] bool is_scale_word(std::string_view key);

}  // namespace robomill::io
