#include "robomill/jobs/decide.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks/named_block.hpp"
#include "robomill/jobs/blocks/scans.hpp"
#include "robomill/jobs/decide/apply.hpp"
#include "robomill/jobs/decide/block_model.hpp"
#include "robomill/jobs/decide/collisions.hpp"
#include "robomill/jobs/decide/outcome.hpp"
#include "robomill/jobs/program_forces.hpp"

namespace robomill::jobs {
namespace {

using decision::LimitUse;
using decision::ProgramDecision;
using decision::ProgramLimit;

/// Choices that the exact run may send back.
constexpr int most_rounds = 4;
/// What a block that broke a limit must keep from it beyond what it missed.
constexpr double tightening = 0.01;
/// Of the force of a block whose load turns round.
constexpr double reversal_step = 0.3;
/// Points of the map of γ along the path.
constexpr std::size_t most_map_points = 400;
/// … and its steps of γ to each side where γ is not free.
constexpr double map_step_rad = 30.0 * units::deg;
constexpr int map_steps = 3;

/// The program at a choice, run and judged.
struct Tried {
  program::Program program;
  std::vector<double> gamma_offset_rad;
  ForcesResult forces;
  ProgramBlocks blocks;
};

/// Runs and judges a program with the same blocks, turned by γ.
Tried run_exactly(const DecideProblem& problem, program::Program program, std::vector<double> gamma_offset_rad,
                  Progress& progress) {
  Tried out;
  const ProgramRun run = {.program = program,
                          .joints = joints_at(problem.forces, program, gamma_offset_rad),
                          .keep_cuts = true,
                          .deflect = problem.forces.program->deflected};
  ForcesFile file = problem.forces.file;
  if (problem.options.is_free(Free::spindle_speed)) file.motion.spindle_speed_rad_per_s = 0.0;  // the program's own
  if (problem.forces.program->stock) file.stock = problem.forces.program->stock->stock;  // not one about a moved path
  out.forces = run_forces_with(std::move(file), problem.forces.program->path, problem.forces.cell, run, progress);
  BlocksOptions options = problem.blocks_options;
  options.scan_points = 0;
  out.blocks = judge_blocks(out.forces, problem.dynamics, options, progress);
  out.program = std::move(program);
  out.gamma_offset_rad = std::move(gamma_offset_rad);
  return out;
}

Tried run_choice(const DecideProblem& problem, const BlockModel& model, const ProgramDecision& choice,
                 Progress& progress) {
  program::Program program = decided_program(problem.forces, model.units(), choice, model.search().free_speed);
  std::vector<double> gamma_offset_rad;
  if (problem.options.is_free(Free::gamma)) gamma_offset_rad = gamma_offsets(program, model.units(), choice);
  return run_exactly(problem, std::move(program), std::move(gamma_offset_rad), progress);
}

/// Loads that a lower feed lowers.
bool rises_with_feed(ProgramLimit limit) {
  constexpr std::array loads = {ProgramLimit::force,        ProgramLimit::torque,       ProgramLimit::power,
                                ProgramLimit::deflection,   ProgramLimit::joint_torque, ProgramLimit::greatest_chip,
                                ProgramLimit::surface_error};
  return std::ranges::find(loads, limit) != loads.end();
}

/// Holds what broke a limit further from it, by its worst block; false: that is not possible.
bool tighten(BlockModel& model, const std::vector<Violation>& violations) {
  std::map<std::size_t, double> more_margin;  // of a class
  std::map<std::size_t, double> feed_share;   // of a line
  for (const Violation& v : violations) {
    if (v.limit == ProgramLimit::stability) {
      double& more = more_margin[model.class_of(v.block)];
      more = std::max(more, v.allowed - v.value + tightening);
      continue;
    }
    const bool reversal = v.limit == ProgramLimit::reversal;
    if (!reversal && !rises_with_feed(v.limit)) return false;
    const double share = reversal ? 1.0 - reversal_step : v.allowed / v.value * (1.0 - tightening);
    double& least = feed_share.try_emplace(model.line_of(v.block), 1.0).first->second;
    least = std::min(least, share);
  }
  for (const auto& [look_class, more] : more_margin) model.tighten_margin(look_class, more);
  for (const auto& [line, share] : feed_share) model.tighten_feed(line, share);
  return true;
}

std::string at_block(const DecideProblem& problem, std::size_t block) {
  return " in " + named_block(problem.forces, block);
}

/// The block of a line that stands for it in messages: the first that cuts.
std::size_t block_of(const BlockModel& model, std::size_t cut) {
  return model.units().lines[cut].cutting.front();
}

std::string infeasible_reason(const DecideProblem& problem, const BlockModel& model, const ProgramDecision& choice) {
  if (choice.rejected.empty()) return "no spindle speed is within the spindle's range";
  const decision::RejectedSpeed& nearest = choice.rejected.front();
  const std::string speed = fmt::format("{:.0f} rpm", nearest.spindle_speed_rad_per_s / units::rpm);
  if (!model.search().free_speed) {
    return fmt::format("the programmed spindle speed does not keep every limit, {}: {}{}", speed,
                       limit_text(nearest.stopped_by), at_block(problem, block_of(model, nearest.cut)));
  }
  return fmt::format("no spindle speed from {:.0f} to {:.0f} rpm keeps every limit; the nearest, {}: {}{}",
                     model.search().min_spindle_speed_rad_per_s / units::rpm,
                     model.search().max_spindle_speed_rad_per_s / units::rpm, speed, limit_text(nearest.stopped_by),
                     at_block(problem, block_of(model, nearest.cut)));
}

void keep_alternatives(const BlockModel& model, const ProgramDecision& choice, DecideResult& out) {
  for (const decision::RejectedSpeed& rejected : choice.rejected) {
    out.alternatives.push_back({.speed = rejected, .block = block_of(model, rejected.cut)});
  }
}

double way_m(const program::Program& program, std::size_t first, std::size_t last) {
  double way = 0.0;
  for (std::size_t i = first; i <= last; ++i) way += (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  return way;
}

/// Speeds, feeds and times of the stretches of the program that was found.
void keep_stretches(const BlockModel& model, const ProgramDecision& choice, DecideResult& out) {
  const ProgramUnits& units = model.units();
  const program::Program& program = *out.program;
  double last_speed = 0.0;
  double last_feed = 0.0;
  for (std::size_t k = 0; k < units.stretches.size(); ++k) {
    const decision::ProgramStretch& stretch = units.stretches[k];
    DecidedLines lines = {.first_block = units.lines[stretch.begin].first_block,
                          .last_block = units.lines[stretch.end - 1].last_block,
                          .spindle_speed_rad_per_s = choice.stretches[k].spindle_speed_rad_per_s,
                          .limited_by = choice.stretches[k].limited_by,
                          .limiting_block = block_of(model, choice.stretches[k].limiting_cut)};
    for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
      const LineUnit& unit = units.lines[c];
      double time_s = 0.0;
      for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) time_s += program.blocks[i].duration_s;
      lines.cutting_time_s += time_s;
      if (unit.turns_only) continue;
      const double feed = way_m(program, unit.first_block, unit.last_block) / time_s;
      const bool first = lines.highest_feed_m_per_s == 0.0;
      lines.lowest_feed_m_per_s = first ? feed : std::min(lines.lowest_feed_m_per_s, feed);
      lines.highest_feed_m_per_s = std::max(lines.highest_feed_m_per_s, feed);
      if (std::abs(feed - last_feed) > 1e-6 * feed) ++out.feeds_changed;
      last_feed = feed;
    }
    if (lines.spindle_speed_rad_per_s != last_speed) ++out.speeds_changed;
    last_speed = lines.spindle_speed_rad_per_s;
    out.stretches.push_back(lines);
  }
}

/// Stability margin over path and γ at the speeds that were chosen, one look a class.
GammaMap gamma_map(const DecideProblem& problem, const BlockModel& model, const DecideResult& result) {
  GammaMap out;
  out.least_margin = problem.machine.depth_margin;
  std::vector<double>& gamma = out.gamma_rad;
  gamma = model.search().gamma_rad;
  if (gamma.size() < 2) {
    gamma.clear();
    for (int k = -map_steps; k <= map_steps; ++k) gamma.push_back(k * map_step_rad);
  }
  const program::Program& program = result.program ? *result.program : problem.forces.program->program;
  std::vector<std::size_t> cutting;
  std::vector<double> way(program.blocks.size() + 1, 0.0);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    way[i + 1] = way[i] + (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
    if (problem.blocks.rows[i].cuts) cutting.push_back(i);
  }
  const std::size_t stride = (cutting.size() + most_map_points - 1) / most_map_points;
  for (std::size_t k = 0; k < cutting.size(); k += std::max<std::size_t>(1, stride)) out.block.push_back(cutting[k]);
  const auto speed_at = [&](std::size_t block) {
    return result.blocks ? program.blocks[block].spindle_speed_rad_per_s
                         : problem.blocks.rows[block].spindle_speed_rad_per_s;
  };
  // Blocks of a class at one speed share their column.
  std::map<std::pair<std::size_t, double>, std::size_t> column;
  std::vector<std::size_t> first;
  for (const std::size_t block : out.block) {
    if (column.emplace(std::pair(model.class_of(block), speed_at(block)), first.size()).second) first.push_back(block);
  }
  Eigen::MatrixXd margin(std::ssize(gamma), std::ssize(first));
  parallel_for(first.size() * gamma.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t block = first[i / gamma.size()];
      margin(static_cast<Eigen::Index>(i % gamma.size()), static_cast<Eigen::Index>(i / gamma.size())) =
          model.margin(model.class_of(block), speed_at(block), gamma[i % gamma.size()]);
    }
  });
  out.margin.resize(std::ssize(gamma), std::ssize(out.block));
  for (std::size_t k = 0; k < out.block.size(); ++k) {
    const std::size_t from = column.at({model.class_of(out.block[k]), speed_at(out.block[k])});
    out.margin.col(static_cast<Eigen::Index>(k)) = margin.col(static_cast<Eigen::Index>(from));
  }
  for (const std::size_t block : out.block) {
    out.path_m.push_back(way[block + 1]);
    out.chosen_rad.push_back(result.gamma_offset_rad.empty() ? 0.0 : result.gamma_offset_rad[block + 1]);
  }
  return out;
}

/// Where the way first comes too near to something; none also where nothing is known of what stands about.
std::optional<NearMiss> near_miss(const DecideProblem& problem, const BlockModel& model, const Tried& tried) {
  if (model.checker() == nullptr) return std::nullopt;
  std::vector<robot::Position6> joints;
  for (const BlockResult& block : tried.forces.program->blocks) joints.emplace_back(block.joints);
  return first_near_miss(*model.checker(), *problem.forces.cell->geometry, joints);
}

/// A program whose ends were moved, at the feeds that its lines had.
program::Program at_feeds_of(const program::Program& moved, const program::Program& before) {
  program::Program out = moved;
  for (std::size_t first = 0; first < out.blocks.size();) {
    std::size_t last = first;
    while (last + 1 < out.blocks.size() && out.blocks[last + 1].line == out.blocks[first].line) ++last;
    const double was_m = way_m(before, first, last);
    const double is_m = way_m(out, first, last);
    for (std::size_t i = first; i <= last && was_m > 0.0 && is_m > 0.0; ++i) out.blocks[i].duration_s *= is_m / was_m;
    first = last + 1;
  }
  return out;
}

/// Feeds lines slower that break a limit of their feed; false: one breaks another limit.
bool slow_down(const BlockModel& model, program::Program& program, const std::vector<Violation>& violations) {
  std::map<std::size_t, double> slower;  // of a line
  for (const Violation& v : violations) {
    if (!rises_with_feed(v.limit)) return false;
    double& most = slower[model.line_of(v.block)];
    most = std::max(most, v.value / v.allowed * (1.0 + tightening));
  }
  for (const auto& [line, factor] : slower) {
    const LineUnit& unit = model.units().lines[line];
    for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) program.blocks[i].duration_s *= factor;
  }
  return true;
}

/// Moves the finishing passes of what was found by the deflection that is predicted, where every limit still holds.
void compensate_found(const DecideProblem& problem, const BlockModel& model, DecideResult& out, Progress& progress) {
  const CompensateOptions options = {.controller_compensates = problem.options.controller_compensates,
                                     .max_offset_m = problem.options.max_offset_m,
                                     .tolerance = problem.blocks_options.tolerance};
  Compensation moved = compensate(*out.forces, problem.dynamics, options, progress);
  out.notes.insert(out.notes.end(), moved.warnings.begin(), moved.warnings.end());
  out.notes.insert(out.notes.end(), moved.notes.begin(), moved.notes.end());
  const bool has_moved =
      moved.status == Compensation::Status::settled || moved.status == Compensation::Status::unsettled;
  if (!has_moved) return;
  program::Program program = at_feeds_of(moved.program, *out.program);
  std::vector<Violation> violations;
  for (int round = 0; round < most_rounds; ++round) {
    Tried tried = run_exactly(problem, program, out.gamma_offset_rad, progress);
    ++out.exact_runs;
    const JudgedRun run(problem, tried.forces, tried.blocks);
    violations = violations_of(run, model.chip_m());
    const std::optional<NearMiss> miss = near_miss(problem, model, tried);
    if (miss && out.collision.empty()) {
      out.notes.push_back(fmt::format("The path is not compensated: {}{}.", near_miss_text(miss->clearance),
                                      at_block(problem, miss->block)));
      return;
    }
    if (violations.empty()) {
      out.decided = outcome_of(run, model.chip_m());
      out.program = std::move(tried.program);
      out.forces = std::move(tried.forces);
      out.blocks = std::move(tried.blocks);
      out.compensation = std::move(moved);
      return;
    }
    if (!slow_down(model, program, violations)) break;
  }
  const Violation& first = violations.front();
  out.notes.push_back(fmt::format("The path is not compensated: the moved one breaks a limit, {}{}.",
                                  limit_text({.limit = first.limit, .value = first.value, .allowed = first.allowed}),
                                  at_block(problem, first.block)));
}

void check_problem(const DecideProblem& problem) {
  problem.options.validate();
  const ForcesResult& forces = problem.forces;
  if (!forces.cell || !forces.program || forces.program->cuts.size() != forces.program->blocks.size()) {
    throw InvalidInput("forces", "must be those along a program, with a cell and the cut of each block");
  }
  if (problem.blocks.cutting == 0) throw InvalidInput("program", "has no block that cuts");
}

/// What was assumed because nobody said it.
std::vector<std::string> assumptions(const DecideProblem& problem, const BlockModel& model) {
  std::vector<std::string> out;
  const decision::ProgramOptions& search = model.search();
  const auto& asked = problem.options.chip_thickness_m;
  if (asked[0] <= 0.0 || asked[1] <= 0.0) {
    out.push_back(fmt::format(
        "Chip thickness is kept between {:.3g} and {:.3g} mm, as far as decide.chip_thickness_mm does not say it: the "
        "least and the greatest of the program as it is.",
        model.chip_m()[0] / units::mm, model.chip_m()[1] / units::mm));
  }
  if (problem.machine.spindle.empty()) {
    out.push_back("Torque and power of the spindle are not limited: [[spindle.curve]] is not given.");
    const bool whole =
        problem.machine.min_spindle_speed_rad_per_s > 0.0 && problem.machine.max_spindle_speed_rad_per_s > 0.0;
    if (search.free_speed && !whole) {
      out.push_back(fmt::format(
          "Spindle speeds are looked for from {:.0f} to {:.0f} rpm, about the program's own: "
          "spindle.min_speed_rpm and max_speed_rpm are not given.",
          search.min_spindle_speed_rad_per_s / units::rpm, search.max_spindle_speed_rad_per_s / units::rpm));
    }
  }
  if (problem.options.is_free(Free::gamma) && model.checker() == nullptr) {
    out.push_back("Nothing checked the turned flange for collisions: the cell has no [geometry].");
  }
  return out;
}

}  // namespace

DecideResult decide(const DecideProblem& problem, Progress& progress) {
  check_problem(problem);
  const auto begun = std::chrono::steady_clock::now();
  DecideResult out;
  BlockModel model(problem);
  out.notes = assumptions(problem, model);
  out.as_programmed = outcome_of(JudgedRun(problem, problem.forces, problem.blocks), model.chip_m());
  ProgramDecision found;
  for (int round = 0; round < most_rounds; ++round) {
    const ProgramDecision choice =
        decision::decide_program(model.units().cuts, model.units().stretches, model, model.search(), progress);
    out.alternatives.clear();
    keep_alternatives(model, choice, out);
    if (choice.status == ProgramDecision::Status::infeasible) {
      out.reason = infeasible_reason(problem, model, choice);
      break;
    }
    Tried tried = run_choice(problem, model, choice, progress);
    ++out.exact_runs;
    const JudgedRun run(problem, tried.forces, tried.blocks);
    const std::optional<NearMiss> miss = near_miss(problem, model, tried);
    if (miss && problem.options.is_free(Free::gamma)) {
      out.reason = fmt::format("on its way {}{}", near_miss_text(miss->clearance), at_block(problem, miss->block));
      break;
    }
    const std::vector<Violation> violations = violations_of(run, model.chip_m());
    if (violations.empty()) {
      if (miss) {
        out.collision = near_miss_text(miss->clearance) + at_block(problem, miss->block);
        out.notes.push_back("The program as it is: " + out.collision + ".");
      }
      out.collisions_checked = model.checker() != nullptr;
      out.status = DecideResult::Status::found;
      out.decided = outcome_of(run, model.chip_m());
      out.gamma_offset_rad = std::move(tried.gamma_offset_rad);
      out.program = std::move(tried.program);
      out.forces = std::move(tried.forces);
      out.blocks = std::move(tried.blocks);
      found = choice;
      break;
    }
    const Violation& first = violations.front();
    out.reason =
        fmt::format("the choice was run {} times and each time broke a limit, the last time {}{}", out.exact_runs,
                    limit_text({.limit = first.limit, .value = first.value, .allowed = first.allowed}),
                    at_block(problem, first.block));
    if (!tighten(model, violations)) break;
  }
  if (out.status == DecideResult::Status::found) {
    out.reason.clear();
    if (problem.options.compensate) compensate_found(problem, model, out, progress);
    keep_stretches(model, found, out);
    if (problem.blocks_options.scan_points > 0) {
      out.blocks->scans = limit_scans(*out.forces, out.blocks->worst, problem.dynamics, problem.blocks_options);
    }
  }
  out.gamma_map = gamma_map(problem, model, out);
  out.evaluations = model.evaluations();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace robomill::jobs
