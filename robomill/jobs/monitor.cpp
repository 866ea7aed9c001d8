#include "robomill/jobs/monitor.hpp"

#include "robomill/base/error.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"

namespace robomill::jobs {

live::AdviceBasis read_advice_basis(const monitor::MonitorFile& file, Progress& progress) {
  live::AdviceBasis basis{.teeth = file.options.teeth, .spindle_speed_rad_per_s = file.options.spindle_speed_rad_per_s};
  if (!file.lobes.empty()) {
    const LobesFile lobes = read_milling(file.lobes);
    if (basis.teeth == 0) basis.teeth = lobes.problem.milling.tool.teeth;
    if (!lobes.problem.dynamics.modes.empty()) basis.modes = lobes.problem.dynamics;
    basis.workpiece = lobes.problem.workpiece_dynamics;
    basis.lobes = stability::compute_lobes(lobes.problem, lobes.options, progress);
  }
  if (!file.modes.empty()) basis.modes = modal::read_modes(file.modes);
  if (basis.modes && basis.teeth == 0) {
    throw InvalidInput(InvalidInput::Parts{.where = file.path.string(),
                                           .field = "process.teeth",
                                           .rule = "must be given beside process.modes",
                                           .hint = "It separates chatter from multiples of tooth passing"});
  }
  return basis;
}

}  // namespace robomill::jobs
