#include "robomill/jobs/monitor.hpp"

#include <cstddef>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::jobs {

namespace {

/// Of each limit: whether the cut just above it is unstable without the wave of the tooth before.
std::vector<bool> coupling_above(const stability::LobesProblem& problem, const stability::LobesResult& lobes,
                                 Progress& progress) {
  constexpr double above = 1.05;
  std::vector<char> found(lobes.limit.size(), 0);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t i = begin; i < end; ++i) {
      const stability::Limit& limit = lobes.limit[i];
      if (limit.status != stability::Limit::Status::found || !(limit.axial_depth_m > 0.0)) continue;
      const stability::ChatterMechanism mechanism = stability::chatter_mechanism(
          problem,
          {.spindle_speed_rad_per_s = limit.spindle_speed_rad_per_s, .axial_depth_m = above * limit.axial_depth_m});
      found[i] = mechanism.kind == stability::ChatterMechanism::Kind::mode_coupling ? 1 : 0;
    }
  });
  return {found.begin(), found.end()};
}

}  // namespace

live::AdviceBasis read_advice_basis(const monitor::MonitorFile& file, Progress& progress) {
  monitor::validate(file);
  live::AdviceBasis basis{.teeth = file.options.teeth,
                          .spindle_speed_rad_per_s = file.options.spindle_speed_rad_per_s,
                          .lowest_rad_per_s = file.act.lowest_rad_per_s,
                          .highest_rad_per_s = file.act.highest_rad_per_s,
                          .unfiltered_sample_rate_hz = file.anti_alias_filter ? 0.0 : file.options.sample_rate_hz};
  if (!file.lobes.empty()) {
    const LobesFile lobes = read_milling(file.lobes);
    if (basis.teeth == 0) basis.teeth = lobes.problem.milling.tool.teeth;
    if (!lobes.problem.dynamics.modes.empty()) basis.modes = lobes.problem.dynamics;
    basis.workpiece = lobes.problem.workpiece_dynamics;
    basis.lobes = stability::compute_lobes(lobes.problem, lobes.options, progress);
    if (basis.modes) basis.mode_coupling = coupling_above(lobes.problem, *basis.lobes, progress);
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
