#include <cmath>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability {
namespace {

void require_range(const char* field, const std::array<double, 2>& range, const char* unit, bool zero_allowed) {
  for (const double end : range) {
    if (!std::isfinite(end)) throw InvalidInput(field, end, unit, "must be a finite number");
  }
  if (!(zero_allowed ? range[0] >= 0.0 : range[0] > 0.0)) {
    throw InvalidInput(field, range[0], unit, zero_allowed ? "must start at 0 or above" : "must start above 0");
  }
  if (!(range[1] > range[0])) {
    throw InvalidInput(field, range[1], unit, "must end above its start", "Give the lower end first");
  }
}

void require_depth(const char* field, double depth_m) {
  if (depth_m > 0.5) {
    throw InvalidInput(field, depth_m, "m", "is deeper than any milling cut", "Are the units mixed up?");
  }
}

}  // namespace

std::string_view to_string(Method method) {
  return name_in(method_names, method);
}

std::string_view to_string(Period period) {
  return period == Period::tooth ? "tooth" : "revolution";
}

std::string_view to_string(BifurcationType kind) {
  switch (kind) {
    case BifurcationType::flip:
      return "flip";
    case BifurcationType::fold:
      return "fold";
    default:
      return "hopf";
  }
}

void LobesOptions::validate() const {
  require_range("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s", false);
  for (const double end : spindle_speed_rad_per_s) cutting::require_spindle_speed("spindle_speed_rad_per_s", end);
  require_range("axial_depth_m", axial_depth_m, "m", true);
  require_depth("axial_depth_m", axial_depth_m[1]);
  for (const int count : grid) {
    if (count < 2) throw InvalidInput("grid", count, "", "must have at least 2 points in each direction");
    if (count > 20000) throw InvalidInput("grid", count, "", "must have at most 20000 points in each direction");
  }
  if (intervals < 4) throw InvalidInput("intervals", intervals, "", "must be at least 4", "40 is usual");
  if (intervals > 10000) throw InvalidInput("intervals", intervals, "", "must be at most 10000", "40 is usual");
  if (!(tolerance >= 1e-10 && tolerance <= 0.1)) {
    throw InvalidInput("tolerance", tolerance, "", "must lie between 1e-10 and 0.1");
  }
  require_non_negative("limit_step_m", limit_step_m, "m");
  if (limit_step_m > 0.0 && limit_step_m * 20000.0 < axial_depth_m[1] - axial_depth_m[0]) {
    throw InvalidInput("limit_step_m", limit_step_m, "m", "must be at least a 20000th of the depths' range");
  }
  for (const OperatingPoint& point : points) {
    cutting::require_spindle_speed("points.spindle_speed_rad_per_s", point.spindle_speed_rad_per_s);
    require_non_negative("points.axial_depth_m", point.axial_depth_m, "m");
    require_depth("points.axial_depth_m", point.axial_depth_m);
    require_positive("points.gain", point.gain, "");
  }
}

void LobesProblem::require_plane(const char* what) const {
  if (!in_three_directions()) return;
  throw InvalidInput(spatial ? "spatial" : "drilling",
                     std::string("must not be there: ") + what + " is known of an upright flat end in x and y alone");
}

void LobesProblem::validate() const {
  if (spatial && drilling) throw InvalidInput("spatial", "must not stand beside drilling");
  if (spatial) spatial->validate();
  if (spatial && spatial->modes_turn_with_tool && !workpiece_dynamics.modes.empty()) {
    throw InvalidInput("modes_turn_with_tool",
                       "must be false where the workpiece vibrates: it does not lean with the tool");
  }
  if (drilling) drilling->validate();
  if (!in_three_directions()) milling.validate();
  require_finite("feed_direction_rad", feed_direction_rad, "rad");
  if (!measured.frfs.empty()) measured.validate();
  if (!workpiece_measured.frfs.empty()) workpiece_measured.validate();
  if (!workpiece_dynamics.modes.empty()) workpiece_dynamics.validate();
  if (!measured.frfs.empty()) {
    if (!dynamics.modes.empty()) throw InvalidInput("modes", "must not stand beside measured FRFs of the tool");
    return;
  }
  dynamics.validate();
  if (dynamics.modes.empty()) throw InvalidInput("modes", "must hold at least one mode");
  static_cast<void>(tip_modes(*this));
}

}  // namespace robomill::stability
