#include "robomill/report/smooth.hpp"

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/report/checks.hpp"

namespace robomill::report {
namespace {

void validate_motion(const std::string& field, const Motion& motion) {
  const Eigen::Index runs = motion.tip_speed_m_per_s.low.size();
  if (runs > 0) require_positive((field + ".run_s").c_str(), motion.run_s, "s");
  require_band(field + ".tip_speed_m_per_s", motion.tip_speed_m_per_s, runs, false);
  require_band(field + ".axis_speed_rad_per_s", motion.axis_speed_rad_per_s, runs, false);
  for (std::size_t k = 0; k < motion.joints.size(); ++k) {
    const JointMotion& joint = motion.joints[k];
    require_band(member(field + ".joints", k, "velocity"), joint.velocity, runs, false);
    require_band(member(field + ".joints", k, "acceleration"), joint.acceleration, runs, false);
    require_band(member(field + ".joints", k, "jerk"), joint.jerk, runs, false);
    require_band(member(field + ".joints", k, "tracking_error"), joint.tracking_error, runs, true);
  }
  require_all_finite(field + ".tip_m", motion.tip_m);
  require_length(field + ".tip_speed_at_m_per_s", motion.tip_speed_at_m_per_s.size(), motion.tip_m.cols(), false);
  require_all_finite(field + ".tip_speed_at_m_per_s", motion.tip_speed_at_m_per_s);
}

}  // namespace

void Smooth::validate() const {
  if (methods.empty()) throw InvalidInput("methods", "must hold at least one");
  require_positive("tip_tolerance_m", tip_tolerance_m, "m");
  require_all_finite("program_m", program_m);
  for (std::size_t k = 0; k < methods.size(); ++k) {
    for (const LimitUse& use : methods[k].uses) {
      if (use.order < 0 || use.order > 3) throw InvalidInput("uses.order", use.order, "", "must be 0 to 3");
    }
    validate_motion(member("methods", k, "motion"), methods[k].motion);
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const CornerView& corner = corners[k];
    require_positive(member("corners", k, "radius_m").c_str(), corner.radius_m, "m");
    require_all_finite(member("corners", k, "program_m"), corner.program_m);
    require_length(member("corners", k, "tip_m"), std::ssize(corner.tip_m), std::ssize(methods), false);
    for (const Eigen::Matrix2Xd& way : corner.tip_m) require_all_finite(member("corners", k, "tip_m"), way);
  }
}

}  // namespace robomill::report
