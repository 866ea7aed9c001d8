#include "robomill/process/decide/block_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/process/decide/outcome.hpp"
#include "robomill/process/program_forces.hpp"

namespace robomill::process {
namespace {

using decision::ProgramDecision;
using decision::ProgramLimit;

/// A speed is looked for within this of the programmed ones where the spindle's range is not given.
constexpr double default_speed_range = 0.4;
/// What a block that broke a limit must keep from it beyond what it missed.
constexpr double tightening = 0.01;
/// Feeds that differ by less say nothing of what a line gains by its feed.
constexpr double other_feed = 0.1;
/// Of the force of a block whose load turns round.
constexpr double reversal_step = 0.3;

/// Greatest chip thickness, least and most: as asked, else as programmed.
std::array<double, 2> chips_m(const DecideProblem& problem, const ProgramUnits& units) {
  const std::array<double, 2> programmed = programmed_chips_m(problem.forces, units.lines);
  const std::array<double, 2>& asked = problem.options.chip_thickness_m;
  std::array<double, 2> out = {};
  for (std::size_t k = 0; k < 2; ++k) out.at(k) = asked.at(k) > 0.0 ? asked.at(k) : programmed.at(k);
  // A side that is not asked for gives way to the one that is.
  if (asked[0] <= 0.0) out[0] = std::min(out[0], out[1]);
  if (asked[1] <= 0.0) out[1] = std::max(out[0], out[1]);
  return out;
}

}  // namespace

BlockModel::BlockModel(const DecideProblem& problem, Progress& progress)
    : problem_(problem), checker_(collision_checker(*problem.forces.cell, problem.forces.cut.cutter)) {
  ProgramUnits units = program_units(problem.forces, problem.blocks, !problem.options.is_free(Free::spindle_speed));
  setting_ = {.problem = &problem,
              .chip_m = chips_m(problem, units),
              .checker = checker_.get(),
              .posture_free = problem.options.is_free(Free::gamma) || (problem.options.leans_free() && checker_),
              .inverse = spherical_wrist(problem.forces.cell->robot.arm)};
  line_of_.assign(problem.blocks.rows.size(), no_line);
  for (std::size_t k = 0; k < units.lines.size(); ++k) {
    for (std::size_t i = units.lines[k].first_block; i <= units.lines[k].last_block; ++i) line_of_[i] = k;
  }
  stretches_ = units.stretches;
  other_ways_.resize(stretches_.size());
  add_way(std::make_unique<WayModel>(setting_, problem.forces, std::move(units)));
  if (problem.options.leans_free()) add_leans(progress);
  set_search();
}

void BlockModel::add_way(std::unique_ptr<WayModel> way) {
  const std::size_t first_class = looks_.size();
  for (std::size_t k = 0; k < way->classes(); ++k) looks_.push_back({.way = ways_.size(), .look_class = k});
  for (decision::ProgramCut cut : way->units().cuts) {
    for (std::size_t& look : cut.looks) look += first_class;
    cuts_.push_back(std::move(cut));
  }
  ways_.push_back(std::move(way));
}

void BlockModel::add_leans(Progress& progress) {
  if (checker_ == nullptr) {
    notes_.emplace_back("Lead and tilt stay as programmed: the cell has no [geometry] to check other ones by.");
    return;
  }
  frames_ = stretch_frames(problem_.forces, units());
  leans_ = lean_ways(problem_, units(), frames_, *checker_, notes_, progress);
  for (const LeanWay& lean : leans_) {
    const std::size_t way = ways_.size();
    add_way(std::make_unique<WayModel>(setting_, lean.forces, units_again(units(), lean.forces)));
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      if (!lean.fails[k].empty()) continue;
      stretches_[k].others.push_back(way * lines() + stretches_[k].begin);
      other_ways_[k].push_back(way);
    }
  }
}

void BlockModel::set_search() {
  const DecideOptions& options = problem_.options;
  const decision::MachineLimits& machine = problem_.machine;
  search_.teeth = problem_.forces.cut.cutter.mill.teeth;
  search_.free_speed = options.is_free(Free::spindle_speed);
  search_.free_feed = options.is_free(Free::feed);
  search_.speed_window = machine.speed_window;
  search_.one_speed = options.speed_changes == SpeedChanges::none;
  search_.ramp_rad_per_s2 = options.goal == Goal::time ? options.spindle_ramp_rad_per_s2 : 0.0;
  search_.speed_step_rad_per_s = 10.0 * units::rpm;
  search_.feed_step_m_per_s = units::mm / units::minute;
  const auto [low, high] = decision::spindle_range(machine);
  const auto [slowest, fastest] =
      std::ranges::minmax(units().stretches, {}, &decision::ProgramStretch::programmed_spindle_speed_rad_per_s);
  const double about_low = (1.0 - default_speed_range) * slowest.programmed_spindle_speed_rad_per_s;
  const double about_high = (1.0 + default_speed_range) * fastest.programmed_spindle_speed_rad_per_s;
  if (low > 0.0 && high > 0.0 && low > high) {
    throw InvalidInput("spindle", "has no speed that both its range and its curve hold",
                       "Look at spindle.min_speed_rpm, max_speed_rpm and curve");
  }
  search_.min_spindle_speed_rad_per_s = low > 0.0 ? low : (high > 0.0 ? std::min(about_low, high) : about_low);
  search_.max_spindle_speed_rad_per_s = high > 0.0 ? high : std::max(about_high, search_.min_spindle_speed_rad_per_s);
  if (!options.is_free(Free::gamma)) return;
  search_.gamma_rad.clear();
  const int below = static_cast<int>(std::floor(-options.gamma_range_rad[0] / options.gamma_step_rad + 1e-9));
  const int above = static_cast<int>(std::floor(options.gamma_range_rad[1] / options.gamma_step_rad + 1e-9));
  for (int k = -below; k <= above; ++k) search_.gamma_rad.push_back(k * options.gamma_step_rad);
}

decision::FeedRange BlockModel::feeds(std::size_t cut, double speed) const {
  return ways_[cut / lines()]->feeds(cut % lines(), speed);
}

decision::CutLook BlockModel::look(std::size_t look_class, double speed, std::size_t gamma) const {
  const Look& look = looks_[look_class];
  if (look.forbidden.contains(gamma)) return {.holds = false, .by = {ProgramLimit::posture, 1.0, 0.0}};
  return ways_[look.way]->look(look.look_class, speed, search_.gamma_rad[gamma]);
}

long long BlockModel::evaluations() const {
  long long out = 0;
  for (const auto& way : ways_) out += way->evaluations();
  return out;
}

std::size_t BlockModel::stretch_of(std::size_t line) const {
  const auto after = std::ranges::upper_bound(stretches_, line, {}, &decision::ProgramStretch::begin);
  return static_cast<std::size_t>(after - stretches_.begin() - 1);
}

std::size_t BlockModel::way_of(const ProgramDecision& choice, std::size_t line) const {
  const std::size_t stretch = stretch_of(line);
  const std::size_t way = choice.stretches[stretch].way;
  return way == 0 ? 0 : other_ways_[stretch][way - 1];
}

std::size_t BlockModel::chosen_cut(const ProgramDecision& choice, std::size_t line) const {
  return way_of(choice, line) * lines() + line;
}

const WayModel& BlockModel::way_at(const ProgramDecision& choice, std::size_t block) const {
  return *ways_[way_of(choice, line_of(block))];
}

std::size_t BlockModel::block_of(std::size_t cut) const {
  const LineUnit& line = ways_[cut / lines()]->units().lines[cut % lines()];
  return line.cutting.empty() ? line.first_block : line.cutting.front();
}

std::vector<Lean> BlockModel::leans(const ProgramDecision& choice) const {
  std::vector<Lean> out;
  for (const decision::ProgramStretch& stretch : stretches_) {
    const std::size_t way = way_of(choice, stretch.begin);
    out.push_back(way == 0 ? Lean{} : leans_[way - 1].lean);
  }
  return out;
}

program::Program BlockModel::chosen_program(const ProgramDecision& choice) const {
  program::Program program =
      frames_.empty() ? problem_.forces.program->program : leant(problem_.forces, units(), frames_, leans(choice));
  std::vector<StretchConditions> conditions(stretches_.size());
  for (std::size_t k = 0; k < stretches_.size(); ++k) {
    if (search_.free_speed) conditions[k].spindle_speed_rad_per_s = choice.stretches[k].spindle_speed_rad_per_s;
    for (std::size_t line = stretches_[k].begin; line < stretches_[k].end; ++line) {
      const std::size_t cut = chosen_cut(choice, line);
      const bool stands = ways_[cut / lines()]->units().lines[line].turns_only;
      conditions[k].slower.push_back(stands ? 1.0 : cuts_[cut].feed_m_per_s / choice.feed_m_per_s[cut]);
    }
  }
  return at_conditions(std::move(program), units(), conditions);
}

std::vector<double> BlockModel::chosen_gamma(const program::Program& program, const ProgramDecision& choice) const {
  if (!problem_.options.is_free(Free::gamma)) return {};
  std::vector<LineGamma> gamma;
  for (std::size_t line = 0; line < lines(); ++line) {
    const std::size_t cut = chosen_cut(choice, line);
    gamma.push_back({.begin_rad = choice.gamma_begin_rad[cut], .end_rad = choice.gamma_end_rad[cut]});
  }
  return gamma_offsets(program, units(), gamma);
}

std::vector<double> BlockModel::line_times(const RobotRun& run) const {
  std::vector<double> out(lines(), 0.0);
  for (std::size_t i = 0; i < std::min(line_of_.size(), run.block_time_s.size()); ++i) {
    if (line_of_[i] != no_line) out[line_of_[i]] += run.block_time_s[i];
  }
  return out;
}

void BlockModel::learn_programmed(const RobotRun& run) {
  programmed_s_ = line_times(run);
}

bool BlockModel::learn_times(const RobotRun& run, const ProgramDecision& choice) {
  bool known = false;
  const std::vector<double> times = line_times(run);
  for (std::size_t line = 0; line < lines(); ++line) {
    if (!(times[line] > 0.0) || !(programmed_s_[line] > 0.0) || units().lines[line].turns_only) continue;
    known = true;
    const double length_m = cuts_[line].length_m;
    const double at_feed_s = length_m / choice.feed_m_per_s[chosen_cut(choice, line)];
    const double saved_s = length_m / cuts_[line].feed_m_per_s - at_feed_s;
    const bool differs = std::abs(saved_s) > other_feed * at_feed_s;
    const double part = differs ? std::clamp((programmed_s_[line] - times[line]) / saved_s, 0.0, 1.0) : 1.0;
    for (std::size_t way = 0; way < ways_.size(); ++way) {
      decision::ProgramCut& cut = cuts_[way * lines() + line];
      cut.feed_part = part;
      cut.lost_s = std::max(times[line] - part * at_feed_s, 0.0);
    }
  }
  return known;
}

double BlockModel::time_s(const ProgramDecision& choice) const {
  double out = choice.ramp_time_s;
  for (std::size_t line = 0; line < lines(); ++line) {
    const std::size_t cut = chosen_cut(choice, line);
    out += cuts_[cut].time_s(choice.feed_m_per_s[cut]);
  }
  return out;
}

bool BlockModel::tighten(const ProgramDecision& choice, const std::vector<Violation>& violations) {
  std::map<std::pair<std::size_t, std::size_t>, double> more_margin;      // of a class of a way
  std::map<std::pair<std::size_t, std::size_t>, double> vibration_share;  // … of the feed per tooth
  std::map<std::size_t, double> feed_share, chip_factor;                  // of a cut
  for (const Violation& v : violations) {
    const std::size_t cut = chosen_cut(choice, line_of(v.block));
    if (v.limit == ProgramLimit::stability) {
      const std::size_t way = cut / lines();
      const std::optional<std::size_t> look_class = ways_[way]->class_of(v.block);
      if (!look_class) return false;
      double& more = more_margin[{way, *look_class}];
      more = std::max(more, v.allowed - v.value + tightening);
    } else if (v.limit == ProgramLimit::forced_vibration) {
      const std::size_t way = cut / lines();
      const std::optional<std::size_t> look_class = ways_[way]->class_of(v.block);
      if (!look_class) return false;
      double& least = vibration_share.try_emplace({way, *look_class}, 1.0).first->second;
      least = std::min(least, v.allowed / v.value * (1.0 - tightening));
    } else if (v.limit == ProgramLimit::least_chip) {
      double& factor = chip_factor.try_emplace(cut, 1.0).first->second;
      factor = std::max(factor, v.allowed / v.value * (1.0 + tightening));
    } else if (v.limit == ProgramLimit::cutting_speed) {
      const double speed = choice.stretches[stretch_of(line_of(v.block))].spindle_speed_rad_per_s;
      ways_[cut / lines()]->set_radius(v.block, v.value / speed);
    } else if (v.limit == ProgramLimit::reversal || rises_with_feed(v.limit)) {
      const double share =
          v.limit == ProgramLimit::reversal ? 1.0 - reversal_step : v.allowed / v.value * (1.0 - tightening);
      double& least = feed_share.try_emplace(cut, 1.0).first->second;
      least = std::min(least, share);
    } else {
      return false;
    }
  }
  for (const auto& [at, more] : more_margin) ways_[at.first]->tighten_margin(at.second, more);
  for (const auto& [at, share] : vibration_share) ways_[at.first]->tighten_vibration(at.second, share);
  for (const auto& [cut, share] : feed_share) ways_[cut / lines()]->tighten_feed(cut % lines(), share);
  for (const auto& [cut, factor] : chip_factor) ways_[cut / lines()]->tighten_chip(cut % lines(), factor);
  return true;
}

bool BlockModel::forbid_at(const ProgramDecision& choice, std::size_t line) {
  const std::size_t cut = chosen_cut(choice, line);
  const std::vector<double>& grid = search_.gamma_rad;
  std::vector<std::size_t> gammas;
  for (const double gamma : {choice.gamma_begin_rad[cut], choice.gamma_end_rad[cut]}) {
    const auto above = std::ranges::lower_bound(grid, gamma - 1e-9);
    const auto k = static_cast<std::size_t>(above - grid.begin());
    if (k < grid.size()) gammas.push_back(k);
    if (k > 0 && (k == grid.size() || grid[k] > gamma + 1e-9)) gammas.push_back(k - 1);
  }
  // The line alone: its classes become its own.
  for (std::size_t& look : cuts_[cut].looks) {
    Look own = looks_[look];
    own.forbidden.insert(gammas.begin(), gammas.end());
    look = looks_.size();
    looks_.push_back(std::move(own));
  }
  return !cuts_[cut].looks.empty();
}

bool BlockModel::forbid(const ProgramDecision& choice, std::size_t block) {
  if (line_of_[block] != no_line) return forbid_at(choice, line_of_[block]);
  // On the way from one line to another: what stands at its end, else at its beginning.
  const auto next = std::ranges::find_if(line_of_.begin() + static_cast<std::ptrdiff_t>(block), line_of_.end(),
                                         [](std::size_t line) { return line != no_line; });
  const std::size_t after = next == line_of_.end() ? lines() : *next;
  return (after < lines() && forbid_at(choice, after)) || (after > 0 && forbid_at(choice, after - 1));
}

}  // namespace robomill::process
