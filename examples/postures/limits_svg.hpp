#pragma once
#include <string>
#include <vector>

namespace robomill::examples {

/// Limit depths of the ten postures, laid over each other by direction: a row of four panels for each set of curves.
struct LimitRow {
  std::string title;
  std::vector<std::vector<double>> limit_m;  ///< of each posture, at each speed; infinite: a gap
};
[[nodiscard]] std::string limits_svg(const std::vector<double>& spindle_speed_rpm, const std::vector<LimitRow>& rows);

}  // namespace robomill::examples
