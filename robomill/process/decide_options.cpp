#include "robomill/process/decide_options.hpp"

#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

#include "robomill/base/error.hpp"

namespace robomill::process {
namespace {

constexpr double least_step_rad = (1.0 - 1e-9) * std::numbers::pi / 180.0;
constexpr double widest_cone_rad = (1.0 + 1e-9) * std::numbers::pi / 4.0;

}  // namespace

void PathOffsets::validate() const {
  require_positive("max_offset_m", max_offset_m, "m");
}

bool DecideOptions::leans_free() const {
  return is_free(Free::lead) || is_free(Free::tilt);
}

bool DecideOptions::is_free(Free what) const {
  return std::ranges::find(free, what) != free.end();
}

void DecideOptions::validate() const {
  if (is_free(Free::axial_depth)) {
    throw InvalidInput("free", "must not hold \"axial_depth\" along a program",
                       "Its depths are those of the CAM: change them there");
  }
  if (leans_free() && !is_free(Free::spindle_speed)) {
    throw InvalidInput("free", "must hold \"spindle_speed\" where it holds \"lead\" or \"tilt\"",
                       "The best speed differs from lean to lean");
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
  offsets.validate();
  if (!(gamma_range_rad[0] <= 0.0 && gamma_range_rad[1] >= 0.0)) {
    throw InvalidInput("gamma_range_rad", "must hold 0, where the program has it");
  }
  constexpr double full_turn_rad = 2.0 * std::numbers::pi;
  if (!(gamma_range_rad[0] >= -full_turn_rad && gamma_range_rad[1] <= full_turn_rad)) {
    throw InvalidInput("gamma_range_rad", "must lie within a full turn to each side");
  }
  for (const auto& [name, step_rad] :
       {std::pair("gamma_step_rad", gamma_step_rad), std::pair("cone_step_rad", cone_step_rad)}) {
    if (!(step_rad >= least_step_rad)) throw InvalidInput(name, step_rad, "rad", "must be >= 1°");
  }
  if (!(cone_rad > 0.0 && cone_rad <= widest_cone_rad)) {
    throw InvalidInput("cone_rad", cone_rad, "rad", "must be above 0 and at most 45°");
  }
}

}  // namespace robomill::process
