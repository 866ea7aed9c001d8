#pragma once
#include <string>

#include "robomill/base/units.hpp"

namespace robomill::cutting {

/// No spindle cuts more slowly, none turns faster.
inline constexpr double slowest_spindle_rad_per_s = units::rpm, fastest_spindle_rad_per_s = 1e6 * units::rpm;
/// @throws InvalidInput unless it lies between them
void require_spindle_speed(const std::string& field, double spindle_speed_rad_per_s);

/// @throws InvalidInput unless in [0, 10 mm]
void require_feed_per_tooth(const std::string& field, double feed_per_tooth_m);

/// What is said beside a value that breaks its rule.
inline constexpr const char* depth_margin_hint = "0.2 stays 20 % below the limit";
inline constexpr const char* speed_window_hint = "0.02 looks at 2 % of speed to each side";

/// Share of a limit that depths keep off, as "depth_margin". @throws InvalidInput unless in [0, 1)
void require_depth_margin(double depth_margin);

/// Of speeds n (1 ± w) beside each, as "speed_window". @throws InvalidInput unless in [0, 0.5)
void require_speed_window(double speed_window);

}  // namespace robomill::cutting
