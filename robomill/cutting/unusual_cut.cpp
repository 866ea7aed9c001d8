#include "robomill/cutting/unusual_cut.hpp"

#include <fmt/format.h>

#include "robomill/base/units.hpp"

namespace robomill::cutting {

std::vector<std::string> unusual_cut(double diameter_m, double feed_per_tooth_m, const FromTo& cutting_speed_m_per_s) {
  constexpr double m_per_min = 1.0 / units::minute;
  constexpr double largest_feed_share = 0.08;  // of the diameter: cutters made for high feed reach 0.06
  constexpr FromTo usual_speed_m_per_s = {8.0 * m_per_min, 8000.0 * m_per_min};
  std::vector<std::string> out;
  if (diameter_m > 0.0 && feed_per_tooth_m > largest_feed_share * diameter_m) {
    out.push_back(fmt::format(
        "A feed per tooth of {:.3g} mm is unusual for a cutter of {:.4g} mm: up to {:.0f} % of the diameter is usual. "
        "Do feed, spindle speed, teeth and diameter fit each other, and are they in mm?",
        feed_per_tooth_m / units::mm, diameter_m / units::mm, 100.0 * largest_feed_share));
  }
  const FromTo& speed = cutting_speed_m_per_s;
  if (speed[1] > 0.0 && (speed[1] < usual_speed_m_per_s[0] || speed[0] > usual_speed_m_per_s[1])) {
    const bool slow = speed[1] < usual_speed_m_per_s[0];
    out.push_back(fmt::format(
        "A cutting speed of {:.3g} m/min is unusual: {:.0f} to {:.0f} m/min is usual. Is the spindle speed in rpm, and "
        "the diameter in mm?",
        (slow ? speed[1] : speed[0]) / m_per_min, usual_speed_m_per_s[0] / m_per_min,
        usual_speed_m_per_s[1] / m_per_min));
  }
  return out;
}

}  // namespace robomill::cutting
