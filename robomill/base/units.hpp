#pragma once
#include <numbers>

/// Shop units in SI: value_m = value_mm * units::mm, value_mm = value_m / units::mm. The only conversions in the
/// project.
// Method: robomill/base/README.md, "Method"
namespace robomill::units {

inline constexpr double mm = 1e-3;
inline constexpr double um = 1e-6;
inline constexpr double inch = 25.4e-3;
inline constexpr double ms = 1e-3;
inline constexpr double us = 1e-6;
inline constexpr double minute = 60.0;
inline constexpr double n_per_mm = 1e3;
inline constexpr double n_per_mm2 = 1e6;
inline constexpr double n_per_mm3 = 1e9;
inline constexpr double mm3 = 1e-9;
inline constexpr double kw = 1e3;
inline constexpr double gpa = 1e9;
inline constexpr double deg = std::numbers::pi / 180.0;
inline constexpr double rpm = std::numbers::pi / 30.0;        ///< rad/s
inline constexpr double standard_gravity = 9.80665;           ///< m/s², "g" of accelerometers
inline constexpr double pound_force = 4.4482216152605;        ///< N
inline constexpr double horsepower = 745.69987158227;         ///< W, 550 ft lbf/s
inline constexpr double revolution = 2.0 * std::numbers::pi;  ///< rad

}  // namespace robomill::units
