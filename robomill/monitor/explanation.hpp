#pragma once
#include <span>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/monitor/README.md, "Method"

namespace robomill::monitor {

/// How a quantity is shown to people. Files keep values and thresholds as they are.
enum class Scale {
  plain,     ///< a share, a ratio to something of the same moment, a count
  decibels,  ///< a ratio of energies: what rose, or stands above the quietest
  seconds,
  hertz
};

/// What a quantity is called.
struct QuantityWords {
  Quantity quantity = Quantity::line_share;
  std::string_view name = {};     ///< in files: "asynchronous_ratio"
  std::string_view meaning = {};  ///< for people, before the value: "energy beside the orders, to theirs"
  Scale scale = Scale::plain;
};

/// All quantities, in the order of the enum.
[[nodiscard]] ROBOMILL_API std::span<const QuantityWords> quantity_words();
[[nodiscard]] ROBOMILL_API const QuantityWords& words_for(Quantity quantity);
/// "dB", "s", "Hz"; empty: a plain number.
[[nodiscard]] ROBOMILL_API std::string_view unit_of(Scale scale);

/// "energy beside the orders, to theirs: 0.31 (at least 0.18)"; "rise of that line in 1.7 s: 14.0 dB (at least 11.0
/// dB)".
[[nodiscard]] ROBOMILL_API std::string condition_text(const Condition& condition);

/// A sentence: in chatter the test with all its conditions, "chatter by ratio (5 of 5 hops): …"; else the first that
/// the closest test lacks, "no alarm; closest is ratio (2 of 5 hops), which lacks …". Empty where no test has anything
/// to go by.
[[nodiscard]] ROBOMILL_API std::string why_text(const Explanation& why, State state);

}  // namespace robomill::monitor
