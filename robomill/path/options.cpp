#include "robomill/path/options.hpp"

#include "robomill/base/error.hpp"

namespace robomill::path {

void SmoothingOptions::validate() const {
  require_positive("tip_tolerance_m", tip_tolerance_m, "m", "0.02 mm suits finishing");
  require_positive("axis_tolerance_rad", axis_tolerance_rad, "rad", "0.02 deg suits finishing");
  constexpr double finest_m = 1e-7, finest_rad = 1e-7;
  if (tip_tolerance_m < finest_m) {
    throw InvalidInput("tip_tolerance_m", tip_tolerance_m, "m", "must be at least 0.1 µm",
                       "0.02 mm suits finishing; no machine follows so closely");
  }
  if (axis_tolerance_rad < finest_rad) {
    throw InvalidInput("axis_tolerance_rad", axis_tolerance_rad, "rad", "must be at least 1e-7 rad, 6e-6 degrees",
                       "0.02 deg suits finishing; no machine follows so closely");
  }
  require_positive("max_velocity_m_per_s", max_velocity_m_per_s, "m/s");
  require_positive("max_acceleration_m_per_s2", max_acceleration_m_per_s2, "m/s^2");
  require_positive("max_jerk_m_per_s3", max_jerk_m_per_s3, "m/s^3");
  require_positive("max_angular_velocity_rad_per_s", max_angular_velocity_rad_per_s, "rad/s");
  require_positive("max_angular_acceleration_rad_per_s2", max_angular_acceleration_rad_per_s2, "rad/s^2");
  require_positive("max_angular_jerk_rad_per_s3", max_angular_jerk_rad_per_s3, "rad/s^3");
  require_positive("sample_period_s", sample_period_s, "s");
  if (sample_period_s < 1e-5 || sample_period_s > 0.1) {
    throw InvalidInput("sample_period_s", sample_period_s, "s", "must lie within 10 µs and 100 ms",
                       "A check of fewer samples proves nothing; robots take one every 1 to 12 ms");
  }
  require_positive("max_duration_s", max_duration_s, "s");
  if (filters < 1 || filters > 3) throw InvalidInput("filters", filters, "", "must be 1, 2 or 3");
  if (filters < 2 && (method == Method::verified || method == Method::optimal)) {
    throw InvalidInput("filters", filters, "", "must be at least 2 where jerk is limited",
                       "One filter steps the acceleration: use method = \"paper\" to look at it");
  }
}

}  // namespace robomill::path
