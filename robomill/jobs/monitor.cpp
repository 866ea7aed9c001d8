#include "robomill/jobs/monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/planned_cut.hpp"
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

/// Of each limit: how deep forced vibration lets the cut go. Empty where the cut has no feed.
std::vector<double> vibration_of(const stability::LobesProblem& problem, const stability::LobesResult& lobes,
                                 Progress& progress) {
  if (!(problem.milling.feed_per_tooth_m > 0.0) || lobes.axial_depth_m.size() == 0) return {};
  std::vector<double> speeds;
  speeds.reserve(lobes.limit.size());
  for (const stability::Limit& limit : lobes.limit) speeds.push_back(limit.spindle_speed_rad_per_s);
  return decision::vibration_depths(problem, speeds, lobes.axial_depth_m.maxCoeff(), progress);
}

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
    if (!lobes.problem.dynamics.modes.empty()) basis.modes = lobes.problem.dynamics;
    basis.workpiece = lobes.problem.workpiece_dynamics;
    basis.lobes = stability::compute_lobes(lobes.problem, lobes.options, progress);
    basis.vibration_depth_m = vibration_of(lobes.problem, *basis.lobes, progress);
    if (basis.modes) basis.mode_coupling = coupling_above(lobes.problem, *basis.lobes, progress);
  }
  std::vector<std::string> notes = file.notes;
  if (!file.modes.empty()) basis.modes = modal::read_modes(file.modes, notes);
  for (std::string& warning : io::take_warnings(notes)) {
    if (std::ranges::find(basis.warnings, warning) == basis.warnings.end())
      basis.warnings.push_back(std::move(warning));
  }
  if (basis.modes && basis.teeth == 0) {
    throw InvalidInput(InvalidInput::Parts{.where = file.path.string(),
                                           .field = "process.teeth",
                                           .rule = "must be given beside process.modes",
                                           .hint = "It separates chatter from multiples of tooth passing"});
  }
  return basis;
}

}  // namespace robomill::jobs
