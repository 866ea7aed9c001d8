#pragma once
#include <array>

namespace robomill::monitor {

inline constexpr std::array mains_hz = {50.0, 60.0};
/// What hum may be taken for: the mains, and half of it, whose multiples they are.
inline constexpr std::array mains_rotation_hz = {25.0, 30.0, 50.0, 60.0};

}  // namespace robomill::monitor
