#include "robomill/process/spindle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/base/units.hpp"

namespace robomill::process {

std::string spindle_warning(const ForcesResult& forces, const std::vector<decision::SpindleCapacity>& curve) {
  if (curve.empty()) return {};
  std::size_t weak = 0;
  SpindleLoad worst;
  double most = 0.0;
  for (const SpindleLoad& load : spindle_loads(forces)) {
    const decision::SpindleCapacity able = decision::capacity_at(curve, load.spindle_speed_rad_per_s);
    const bool inside = able.torque_n_m > 0.0 && able.power_w > 0.0;
    const double share = inside ? std::max(load.torque_n_m / able.torque_n_m, load.power_w / able.power_w) : HUGE_VAL;
    if (!(share > 1.0)) continue;
    if (++weak == 1 || share > most) {
      most = share;
      worst = load;
    }
  }
  if (weak == 0) return {};
  const std::string place = worst.line > 0 ? fmt::format("in {} blocks, most in line {}: ", weak, worst.line) : "";
  const decision::SpindleCapacity able = decision::capacity_at(curve, worst.spindle_speed_rad_per_s);
  const std::string has = std::isinf(most) ? std::string("that speed is outside the spindle's curve")
                                           : fmt::format("the spindle has {:.3g} N·m and {:.3g} kW", able.torque_n_m,
                                                         able.power_w / units::kw);
  return fmt::format(
      "The cut asks for more than the spindle has, {}{:.3g} N·m over a revolution and {:.3g} kW over {:.3g} s at "
      "{:.0f} rpm; {}.",
      place, worst.torque_n_m, worst.power_w / units::kw, forces.cut.power_time_s,
      worst.spindle_speed_rad_per_s / units::rpm, has);
}

std::optional<decision::SpindleCapacity> capacity_along(const ForcesResult& forces,
                                                        const std::vector<decision::SpindleCapacity>& curve) {
  const std::vector<SpindleLoad> loads = spindle_loads(forces);
  if (!forces.program || curve.empty() || loads.empty()) return std::nullopt;
  const double speed = loads.front().spindle_speed_rad_per_s;
  if (std::ranges::any_of(loads, [&](const SpindleLoad& l) { return l.spindle_speed_rad_per_s != speed; })) {
    return std::nullopt;
  }
  return decision::capacity_at(curve, speed);
}

}  // namespace robomill::process
