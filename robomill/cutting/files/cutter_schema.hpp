#pragma once
#include "robomill/cutting/cutter.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cutting {

/// The edges' angle: a key of [tool], and of [coefficients] where that takes another one.
inline constexpr const char* helix_key = "helix_deg";

/// [tool] of a milling cutter.
[[nodiscard]] const io::Schema<Cutter>& cutter_table();
/// [process_damping]
[[nodiscard]] const io::Schema<ProcessDamping>& process_damping_table();
/// [speed_variation]
[[nodiscard]] const io::Schema<SpeedVariation>& speed_variation_table();

}  // namespace robomill::cutting
