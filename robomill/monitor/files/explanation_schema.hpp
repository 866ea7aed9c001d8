#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::monitor {

/// "why" of an event and of an alarm.
[[nodiscard]] const io::Schema<Explanation>& explanation_table();

/// Null where no test has anything to go by: the published detector's, or no samples.
[[nodiscard]] inline const Explanation* known(const Explanation& why) {
  return why.test == Test::none ? nullptr : &why;
}

/// The same as a document's value.
[[nodiscard]] inline io::Json explanation_json(const Explanation& why) {
  return known(why) == nullptr ? io::Json(nullptr) : explanation_table().write(why);
}

}  // namespace robomill::monitor
