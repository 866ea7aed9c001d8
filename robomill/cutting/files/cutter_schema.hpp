#pragma once
#include "robomill/cutting/cutter.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cutting {

/// [tool] of a milling cutter.
[[nodiscard]] const io::Table<Cutter>& cutter_table();
/// [process_damping]
[[nodiscard]] const io::Table<ProcessDamping>& process_damping_table();
/// [speed_variation]
[[nodiscard]] const io::Table<SpeedVariation>& speed_variation_table();

}  // namespace robomill::cutting
