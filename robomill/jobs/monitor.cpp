#include "robomill/jobs/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/planned_cut.hpp"
#include "robomill/modal/files/modes_files.hpp"

namespace robomill::jobs {

namespace {

/// @throws InvalidInput where monitor.toml says other teeth than its lobes, or allows no speed of theirs
void require_cut_of(const monitor::MonitorFile& file, const LobesFile& lobes) {
  const auto reject = [&](const char* field, std::string rule, const char* hint) {
    throw InvalidInput(
        InvalidInput::Parts{.where = file.path.string(), .field = field, .rule = std::move(rule), .hint = hint});
  };
  const int teeth = lobes.problem.milling.tool.teeth;
  if (file.options.teeth != 0 && file.options.teeth != teeth) {
    reject("process.teeth",
           fmt::format("is {}, and {} has a cutter of {}", file.options.teeth, lobes.path.string(), teeth),
           "Correct the one that is wrong");
  }
  const auto [low, high] = lobes.options.spindle_speed_rad_per_s;
  const double highest = file.act.highest_rad_per_s;
  if (highest > 0.0 && (highest < low || file.act.lowest_rad_per_s > high)) {
    reject("act.spindle_speed_rpm",
           fmt::format("is {:.6g} to {:.6g} rpm, and the lobes of {} go from {:.6g} to {:.6g} rpm",
                       file.act.lowest_rad_per_s / units::rpm, highest / units::rpm, lobes.path.string(),
                       low / units::rpm, high / units::rpm),
           "No speed is in both: none could be suggested");
  }
}

/// The cut that process.lobes names: of a job as its plan has it, with its range and margin; else with the structure of
/// its own, or with process.modes.
LobesFile cut_of(const monitor::MonitorFile& file, live::AdviceBasis& basis, Progress& progress) {
  LobesFile cut = read_lobes(file.lobes);
  const std::vector<std::filesystem::path> jobs = jobs_of_cut(file.lobes);
  if (jobs.size() > 1) basis.notes.push_back(several_jobs_text(jobs, file.lobes));
  if (jobs.size() == 1) {
    const PlanResult structure = run_structure(jobs.front(), default_seed, progress);
    take_plan(cut, structure);
    basis.depth_margin = structure.job.recommend.depth_margin;
    basis.speed_window = structure.job.recommend.speed_window;
    if (!(basis.highest_rad_per_s > 0.0)) {
      const std::array<double, 2>& chart = cut.options.spindle_speed_rad_per_s;
      const std::array<double, 2> spindle = decision::spindle_range(structure.job.recommend);
      basis.lowest_rad_per_s = std::max(chart[0], spindle[0]);
      basis.highest_rad_per_s = spindle[1] > 0.0 ? std::min(chart[1], spindle[1]) : chart[1];
    }
  } else {
    load_dynamics(cut, progress);
    const bool nothing = cut.problem.dynamics.modes.empty() && cut.problem.measured.frfs.empty();
    if (nothing && !file.modes.empty()) cut.problem.dynamics = modal::read_modes(file.modes, cut.notes);
  }
  require_plane(cut);
  cut.validate();
  require_cut_of(file, cut);
  add_assumed(basis.assumed, assumed_of(cut, CutUse::stability));
  std::ranges::move(io::take_warnings(cut.notes), std::back_inserter(basis.warnings));
  basis.notes.insert(basis.notes.end(), cut.notes.begin(), cut.notes.end());
  return cut;
}

}  // namespace

live::AdviceBasis read_advice_basis(const monitor::MonitorFile& file, Progress& progress) {
  monitor::validate(file);
  live::AdviceBasis basis{.teeth = file.options.teeth,
                          .spindle_speed_rad_per_s = file.options.spindle_speed_rad_per_s,
                          .lowest_rad_per_s = file.act.lowest_rad_per_s,
                          .highest_rad_per_s = file.act.highest_rad_per_s,
                          .unfiltered_sample_rate_hz = file.anti_alias_filter ? 0.0 : file.options.sample_rate_hz};
  add_assumed(basis.assumed, file.assumed);
  if (!file.lobes.empty()) {
    const LobesFile lobes = cut_of(file, basis, progress);
    if (basis.teeth == 0) basis.teeth = lobes.problem.milling.tool.teeth;
    basis.take_cut(lobes.problem, lobes.options, progress);
  }
  std::vector<std::string> notes = file.notes;
  if (!file.modes.empty()) basis.modes = modal::read_modes(file.modes, notes);
  for (std::string& warning : io::take_warnings(notes)) {
    if (std::ranges::find(basis.warnings, warning) == basis.warnings.end())
      basis.warnings.push_back(std::move(warning));
  }
  std::ranges::move(notes, std::back_inserter(basis.notes));
  if (basis.modes && basis.teeth == 0) {
    throw InvalidInput(InvalidInput::Parts{.where = file.path.string(),
                                           .field = "process.teeth",
                                           .rule = "must be given beside process.modes",
                                           .hint = "It separates chatter from multiples of tooth passing"});
  }
  return basis;
}

}  // namespace robomill::jobs
