#include "robomill/cutting/cut_limits.hpp"

#include "robomill/base/error.hpp"

namespace robomill::cutting {

void require_spindle_speed(const std::string& field, double spindle_speed_rad_per_s) {
  constexpr double rounding = 1e-9;
  require_positive(field.c_str(), spindle_speed_rad_per_s, "rad/s");
  if (spindle_speed_rad_per_s < slowest_spindle_rad_per_s * (1.0 - rounding)) {
    throw InvalidInput(field, spindle_speed_rad_per_s, "rad/s", "must be at least 1 rpm",
                       "No spindle cuts so slowly; are the units mixed up?");
  }
  if (spindle_speed_rad_per_s > fastest_spindle_rad_per_s * (1.0 + rounding)) {
    throw InvalidInput(field, spindle_speed_rad_per_s, "rad/s", "must be at most 1,000,000 rpm",
                       "No spindle is so fast; are the units mixed up?");
  }
}

void require_feed_per_tooth(const std::string& field, double feed_per_tooth_m) {
  constexpr double most_m = 0.01;
  require_non_negative(field.c_str(), feed_per_tooth_m, "m");
  if (feed_per_tooth_m > most_m) {
    throw InvalidInput(field, feed_per_tooth_m, "m", "is too large for any cutter",
                       "0.1 mm = 1e-4 m is usual; are the units mixed up?");
  }
}

void require_depth_margin(double depth_margin) {
  if (depth_margin >= 0.0 && depth_margin < 1.0) return;
  throw InvalidInput("depth_margin", depth_margin, "", "must be in [0, 1)", depth_margin_hint);
}

void require_speed_window(double speed_window) {
  if (speed_window >= 0.0 && speed_window < 0.5) return;
  throw InvalidInput("speed_window", speed_window, "", "must be in [0, 0.5)", speed_window_hint);
}

}  // namespace robomill::cutting
