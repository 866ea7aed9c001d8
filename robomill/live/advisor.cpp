#include "robomill/live/advisor.hpp"

#include "robomill/monitor/advice.hpp"

namespace robomill::live {
namespace {

/// Of the limit of depth, as a plan keeps it.
constexpr double depth_margin = 0.2;

}  // namespace

void Advisor::advise(monitor::MonitorEvent& event) const {
  const monitor::Decision& d = event.decision;
  const double speed_rad_per_s =
      d.spindle_speed_rad_per_s > 0.0 ? d.spindle_speed_rad_per_s : basis_.spindle_speed_rad_per_s;
  if (!(d.chatter_frequency_hz > 0.0) || basis_.teeth < 1 || !(speed_rad_per_s > 0.0)) return;
  const monitor::Advice advice = monitor::advise(d.chatter_frequency_hz, d.chatter_frequency_std_hz, speed_rad_per_s,
                                                 basis_.teeth, basis_.modes ? &*basis_.modes : nullptr,
                                                 basis_.lobes ? &*basis_.lobes : nullptr, {}, basis_.workpiece);
  event.mode = advice.mode;
  for (const monitor::StableSpeed& stable : advice.speeds) {
    event.stable_speeds_rad_per_s.push_back(stable.spindle_speed_rad_per_s);
  }
  if (advice.best) {
    event.suggested_spindle_speed_rad_per_s = advice.best->spindle_speed_rad_per_s;
    event.suggested_axial_depth_m = (1.0 - depth_margin) * advice.best->axial_depth_m;
  } else if (!event.stable_speeds_rad_per_s.empty()) {
    event.suggested_spindle_speed_rad_per_s = event.stable_speeds_rad_per_s.front();
  }
}

}  // namespace robomill::live
