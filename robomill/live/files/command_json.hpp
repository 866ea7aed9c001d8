#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/live/act.hpp"

namespace robomill::live {

/// One line of JSON with its end, as it goes to mqtt.commands_topic: docs/formats.md, "Commands".
/// @param decided_unix_s  when the decision was made, by this machine's clock
[[nodiscard]] ROBOMILL_API std::string command_line(const Command& command, double decided_unix_s);

}  // namespace robomill::live
