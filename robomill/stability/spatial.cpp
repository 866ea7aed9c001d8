#include "robomill/stability/spatial.hpp"

#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::stability {

void SpatialMilling::validate() const {
  cut.validate(cutter);
  require_non_negative("feed_per_tooth_m", feed_per_tooth_m, "m");
  if (cutter.mill.runout_m > 0.0) {
    require_positive("feed_per_tooth_m", feed_per_tooth_m, "m",
                     "Where there is runout it decides which teeth miss the cut");
  }
  if (coefficients.tangential_n_per_m2.empty()) coefficients.validate(0.0, 0.0);
}

void Drilling::validate() const {
  if (lips < 1 || lips > 100) throw InvalidInput("lips", lips, "", "must lie between 1 and 100");
  require_positive("diameter_m", diameter_m, "m");
  if (!(point_angle_rad > 0.0 && point_angle_rad <= std::numbers::pi)) {
    throw InvalidInput("point_angle_rad", point_angle_rad, "rad", "must lie between 0 and 180 degrees",
                       "118 degrees is usual");
  }
  coefficients.validate();
}

}  // namespace robomill::stability
