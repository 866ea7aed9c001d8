#pragma once

namespace robomill::test {

/// A lobes.toml that is computed in a moment: a slot, one mode in x and one in y.
inline constexpr const char* slot_lobes = R"(# a slot
[tool]
teeth = 2           # edges
diameter_mm = 10
[cut]
direction = "slot"
feed_per_tooth_mm = 0.05
[coefficients]
tangential_n_per_mm2 = 700
radial_n_per_mm2 = 200
[dynamics]
x = [{ frequency_hz = 900, damping_ratio = 0.02, modal_mass_kg = 0.1 }]
y = [{ frequency_hz = 950, damping_ratio = 0.02, modal_mass_kg = 0.1 }]
[lobes]
spindle_speed_rpm = [6000, 18000]
axial_depth_mm = [0, 3]
grid = [40, 30]
)";

}  // namespace robomill::test
