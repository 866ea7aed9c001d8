#pragma once
#include <filesystem>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/machine.hpp"

// Method: robomill/monitor/README.md, "Machines that were learnt"

namespace robomill::monitor {

/// machine.json. @throws InvalidInput as Machine::validate
[[nodiscard]] ROBOMILL_API std::string machine_json(const Machine& machine);

/// @throws InvalidInput with file and place if it is missing or no such document
[[nodiscard]] ROBOMILL_API Machine read_machine(const std::filesystem::path& path);

/// Reads the machine that monitor.toml names into its options; nothing where it names none.
/// @throws InvalidInput as read_machine
ROBOMILL_API void load_machine(MonitorFile& file);

/// What was learnt, in lines of text for people.
[[nodiscard]] ROBOMILL_API std::string machine_text(const Machine& machine);

}  // namespace robomill::monitor
