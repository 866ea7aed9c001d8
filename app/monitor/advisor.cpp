#include "advisor.hpp"

#include "robomill/base/error.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/advice.hpp"

namespace robomill::app {
namespace {

/// Of the limit of depth, as a plan keeps it.
constexpr double depth_margin = 0.2;

}  // namespace

Advisor::Advisor(const monitor::MonitorFile& file, Progress& progress)
    : teeth_(file.options.teeth), hint_rad_per_s_(file.options.spindle_speed_rad_per_s) {
  if (!file.lobes.empty()) {
    jobs::LobesFile lobes = jobs::read_lobes(file.lobes);
    jobs::load_dynamics(lobes);
    if (lobes.drilling) throw InvalidInput(file.lobes.string(), "lobes are those of milling");
    lobes.validate();
    if (teeth_ == 0) teeth_ = lobes.problem.milling.tool.teeth;
    if (!lobes.problem.dynamics.modes.empty()) modes_ = lobes.problem.dynamics;
    workpiece_ = lobes.problem.workpiece_dynamics;
    lobes_ = stability::compute_lobes(lobes.problem, lobes.options, progress);
  }
  if (!file.modes.empty()) modes_ = modal::read_modes(file.modes);
  if (modes_ && teeth_ == 0) {
    throw InvalidInput(InvalidInput::Parts{.where = file.path.string(),
                                           .field = "process.teeth",
                                           .rule = "must be given beside process.modes",
                                           .hint = "Chatter is told from multiples of tooth passing by it"});
  }
}

void Advisor::advise(monitor::MonitorEvent& event) const {
  const monitor::Decision& d = event.decision;
  const double speed_rad_per_s = d.spindle_speed_rad_per_s > 0.0 ? d.spindle_speed_rad_per_s : hint_rad_per_s_;
  if (!(d.chatter_frequency_hz > 0.0) || teeth_ < 1 || !(speed_rad_per_s > 0.0)) return;
  const monitor::Advice advice =
      monitor::advise(d.chatter_frequency_hz, d.chatter_frequency_std_hz, speed_rad_per_s, teeth_,
                      modes_ ? &*modes_ : nullptr, lobes_ ? &*lobes_ : nullptr, {}, workpiece_);
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

}  // namespace robomill::app
