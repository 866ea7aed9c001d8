#pragma once
#include <string>

namespace robomill::modal {

/// What the made-up hits.toml names.
inline constexpr const char* example_hit_name = "example_hit_x.csv";

/// A record as a tap test gives it, made up: one hit in x on a single mode at 620 Hz, 3 % of critical, 0.6 kg, as
/// `time_s,force_n,ax_m_per_s2`.
[[nodiscard]] std::string example_hit_csv();

}  // namespace robomill::modal
