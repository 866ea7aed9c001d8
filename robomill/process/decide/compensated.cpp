#include "robomill/process/decide/compensated.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/process/decide/exact_run.hpp"
#include "robomill/process/decide/outcome.hpp"

namespace robomill::process {
namespace {

/// Slower feeds that are tried.
constexpr int most_slower = 4;
/// What a block that broke a limit must keep from it beyond what it missed.
constexpr double slower_margin = 0.01;

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
    most = std::max(most, v.value / v.allowed * (1.0 + slower_margin));
  }
  for (const auto& [line, factor] : slower) {
    const LineUnit& unit = model.units().lines[line];
    for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) program.blocks[i].duration_s *= factor;
  }
  return true;
}

}  // namespace

void compensate_found(const DecideProblem& problem, const BlockModel& model, DecideResult& out, Progress& progress) {
  const CompensateOptions options = {.offsets = problem.options.offsets, .tolerance = problem.blocks_options.tolerance};
  Compensation moved = compensate(*out.forces, problem.dynamics, options, progress);
  out.notes.insert(out.notes.end(), moved.warnings.begin(), moved.warnings.end());
  out.notes.insert(out.notes.end(), moved.notes.begin(), moved.notes.end());
  const bool has_moved =
      moved.status == Compensation::Status::settled || moved.status == Compensation::Status::unsettled;
  if (!has_moved) return;
  StandingProgram standing = {.program = at_feeds_of(moved.program, out.forces->program->program), .stands = {}};
  const auto not_compensated = [&](const std::string& why, std::size_t block) {
    out.notes.push_back(fmt::format("The path is not compensated: {} in {}.", why, named_block(problem.forces, block)));
  };
  standing.stands = joints_at(problem.forces, standing.program, out.gamma_offset_rad);
  if (standing.stands.lost) {
    not_compensated("the robot cannot stand so", *standing.stands.lost);
    return;
  }
  const std::vector<NearMiss> misses = near_misses(model.checker(), *problem.forces.cell, standing.stands);
  if (!misses.empty() && out.collision.empty()) {
    not_compensated(cell::near_miss_text(misses.front().clearance), misses.front().block);
    return;
  }
  std::vector<Violation> violations;
  for (int round = 0; round < most_slower; ++round) {
    Tried tried = run_exactly(problem, standing, progress);
    ++out.exact_runs;
    const JudgedRun run(problem, tried.forces, tried.blocks);
    violations = violations_of(run, model.chip_m());
    if (violations.empty()) {
      out.decided = outcome_of(run, model.chip_m());
      out.forces = std::move(tried.forces);
      out.blocks = std::move(tried.blocks);
      out.compensation = std::move(moved);
      return;
    }
    if (!slow_down(model, standing.program, violations)) break;
  }
  const Violation& first = violations.front();
  not_compensated("the moved one breaks a limit, " + limit_text(first), first.block);
}

}  // namespace robomill::process
