#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/monitor/machine.hpp"

namespace robomill::monitor {

/// The keys of machine.json.
[[nodiscard]] const io::Schema<Machine>& machine_table();

}  // namespace robomill::monitor
