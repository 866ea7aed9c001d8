#include "robomill/jobs/decide_options.hpp"

#include <algorithm>
#include <string>
#include <tuple>

#include "robomill/base/error.hpp"

namespace robomill::jobs {

bool DecideOptions::is_free(Free what) const {
  return std::ranges::find(free, what) != free.end();
}

void DecideOptions::validate() const {
  for (const Free what : {Free::axial_depth, Free::lead, Free::tilt}) {
    if (!is_free(what)) continue;
    throw InvalidInput("free", "must not hold \"" + std::string(name_in(free_names, what)) + "\" along a program",
                       what == Free::axial_depth ? "Its depths are those of the CAM: change them there"
                                                 : "Its axes are those of the CAM: nothing checks other ones for "
                                                   "gouges and collisions");
  }
  require_positive("spindle_ramp_rad_per_s2", spindle_ramp_rad_per_s2, "rad/s^2");
  require_non_negative("max_force_n", max_force_n, "N");
  require_non_negative("max_deflection_m", max_deflection_m, "m");
  require_non_negative("max_feed_m_per_s", max_feed_m_per_s, "m/s");
  for (const auto& [name, range, unit] : {std::tuple("chip_thickness_m", chip_thickness_m, "m"),
                                          std::tuple("cutting_speed_m_per_s", cutting_speed_m_per_s, "m/s")}) {
    require_non_negative(name, range[0], unit);
    require_non_negative(name, range[1], unit);
    if (range[1] > 0.0 && range[0] > range[1]) throw InvalidInput(name, range[0], unit, "must not be above the most");
  }
  require_positive("max_offset_m", max_offset_m, "m");
  require_positive("gamma_step_rad", gamma_step_rad, "rad");
  if (!(gamma_range_rad[0] <= 0.0 && gamma_range_rad[1] >= 0.0)) {
    throw InvalidInput("gamma_range_rad", "must hold 0, where the program has it");
  }
}

}  // namespace robomill::jobs
