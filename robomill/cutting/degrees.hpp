#pragma once
#include <cmath>
#include <numbers>
#include <string>

namespace robomill::cutting::detail {

/// An angle in degrees with two decimals, for a message.
inline std::string degrees(double angle_rad) {
  std::string text = std::to_string(std::round(angle_rad * 18000.0 / std::numbers::pi) / 100.0);
  text.resize(text.size() - 4);
  return text;
}

}  // namespace robomill::cutting::detail
