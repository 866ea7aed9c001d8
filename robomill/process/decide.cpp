#include "robomill/process/decide.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/blocks/scans.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/process/decide/as_it_is.hpp"
#include "robomill/process/decide/block_model.hpp"
#include "robomill/process/decide/collisions.hpp"
#include "robomill/process/decide/compensated.hpp"
#include "robomill/process/decide/exact_run.hpp"
#include "robomill/process/decide/gamma_map.hpp"
#include "robomill/process/decide/outcome.hpp"
#include "robomill/process/program_forces.hpp"

namespace robomill::process {
namespace {

using decision::LimitUse;
using decision::ProgramDecision;
using decision::ProgramLimit;

/// Choices that the exact run may send back, and those that need none: the robot cannot stand so.
constexpr int most_rounds = 4, most_detours = 60;
/// Another choice is run where it promises to save this share of the time of the best so far.
constexpr double worth_a_run = 0.01;

std::string at_block(const DecideProblem& problem, std::size_t block) {
  return " in " + named_block(problem.forces, block);
}

std::string infeasible_reason(const DecideProblem& problem, const BlockModel& model, const ProgramDecision& choice) {
  if (choice.rejected.empty()) return "no spindle speed is within the spindle's range";
  const decision::RejectedSpeed& nearest = choice.rejected.front();
  const std::string speed = fmt::format("{:.0f} rpm", nearest.spindle_speed_rad_per_s / units::rpm);
  if (!model.search().free_speed) {
    return fmt::format("the programmed spindle speed does not keep every limit, {}: {}{}", speed,
                       limit_text(nearest.stopped_by), at_block(problem, model.block_of(nearest.cut)));
  }
  return fmt::format("no spindle speed from {:.0f} to {:.0f} rpm keeps every limit; the nearest, {}: {}{}",
                     model.search().min_spindle_speed_rad_per_s / units::rpm,
                     model.search().max_spindle_speed_rad_per_s / units::rpm, speed, limit_text(nearest.stopped_by),
                     at_block(problem, model.block_of(nearest.cut)));
}

void keep_alternatives(const BlockModel& model, const ProgramDecision& choice, DecideResult& out) {
  for (const decision::RejectedSpeed& rejected : choice.rejected) {
    out.alternatives.push_back({.speed = rejected, .block = model.block_of(rejected.cut)});
  }
}

/// Speeds, feeds and times of the stretches of the program that was found.
void keep_stretches(const BlockModel& model, const ProgramDecision& choice, DecideResult& out) {
  const ProgramUnits& units = model.units();
  const program::Program& program = out.forces->program->program;
  const std::vector<Lean> leans = model.leans(choice);
  double last_speed = 0.0;
  double last_feed = 0.0;
  for (std::size_t k = 0; k < units.stretches.size(); ++k) {
    const decision::ProgramStretch& stretch = units.stretches[k];
    DecidedLines lines = {.first_block = units.lines[stretch.begin].first_block,
                          .last_block = units.lines[stretch.end - 1].last_block,
                          .spindle_speed_rad_per_s = choice.stretches[k].spindle_speed_rad_per_s,
                          .lead_rad = leans[k].lead_rad,
                          .tilt_rad = leans[k].tilt_rad,
                          .limited_by = choice.stretches[k].limited_by,
                          .limiting_block = model.block_of(choice.stretches[k].limiting_cut)};
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

void check_problem(const DecideProblem& problem) {
  problem.options.validate();
  require_cuts(problem.forces);
  if (problem.blocks.cutting == 0) throw InvalidInput("program", "has no block that cuts");
}

std::vector<Assumption> assumed_of(const DecideProblem& problem, const BlockModel& model) {
  std::vector<Assumption> out;
  const auto add = [&out](const char* what, std::string taken, const char* key) {
    out.push_back({.what = what, .taken = std::move(taken), .key = key});
  };
  const decision::ProgramOptions& search = model.search();
  const auto& asked = problem.options.chip_thickness_m;
  if (asked[0] <= 0.0 || asked[1] <= 0.0) {
    add("Chip thickness",
        fmt::format("from {:.3g} to {:.3g} mm, the least and the greatest of the program as it is",
                    model.chip_m()[0] / units::mm, model.chip_m()[1] / units::mm),
        "decide.chip_thickness_mm");
  }
  if (problem.machine.spindle.empty()) {
    add("Torque and power of the spindle", "not limited", "spindle.curve");
    const bool whole =
        problem.machine.min_spindle_speed_rad_per_s > 0.0 && problem.machine.max_spindle_speed_rad_per_s > 0.0;
    if (search.free_speed && !whole) {
      add("Spindle speeds",
          fmt::format("from {:.0f} to {:.0f} rpm, about the program's own",
                      search.min_spindle_speed_rad_per_s / units::rpm, search.max_spindle_speed_rad_per_s / units::rpm),
          "spindle.min_speed_rpm");
    }
  }
  return out;
}

/// A choice that the robot can stand in, as far as it is not the program's own; none: there is none.
struct Chosen {
  ProgramDecision choice;
  StandingProgram standing;
  std::vector<double> gamma_offset_rad;
  std::optional<NearMiss> miss;  ///< of the program as it is
};

/// A choice that keeps every limit as it was run.
struct Kept {
  Chosen chosen;
  Tried tried;
  Outcome outcome;
  std::vector<RejectedAlternative> alternatives;
  /// What it is judged by, where the robot's time is known.
  [[nodiscard]] double time_s() const { return outcome.robot_time_s + chosen.choice.ramp_time_s; }
};

class Decider {
 public:
  Decider(const DecideProblem& problem, Progress& progress)
      : problem_(problem), progress_(progress), model_(problem, progress) {}

  DecideResult run() {
    out_.notes = model_.notes();
    out_.assumed = assumed_of(problem_, model_);
    const JudgedRun programmed(problem_, problem_.forces, problem_.blocks);
    out_.as_programmed = outcome_of(programmed, model_.chip_m());
    std::vector<Violation> of_motion;
    model_.learn_programmed(on_robot(programmed, {}, out_.as_programmed, of_motion));
    std::optional<Kept> found = find();
    if (found) {
      if (of_motion.empty()) prefer_program(*found);
      keep(*found);
      const ProgramDecision& choice = found->chosen.choice;
      if (problem_.options.compensate) compensate_found(problem_, model_, out_, progress_);
      keep_stretches(model_, choice, out_);
      if (problem_.blocks_options.scan_points > 0) {
        out_.blocks->scans = limit_scans(*out_.forces, out_.blocks->worst, problem_.dynamics, problem_.blocks_options);
      }
    }
    out_.gamma_map = gamma_map(problem_, model_, found ? &found->chosen.choice : nullptr, out_, progress_);
    out_.evaluations = model_.evaluations();
    return std::move(out_);
  }

 private:
  /// Of the choices that keep every limit when they are run the one that takes least time.
  std::optional<Kept> find() {
    std::optional<Kept> best;
    for (int round = 0; round < most_rounds; ++round) {
      std::optional<Chosen> chosen = choose();
      if (!chosen) break;
      const double time_s = model_.time_s(chosen->choice);
      if (best && !(time_s < (1.0 - worth_a_run) * model_.time_s(best->chosen.choice))) break;
      Tried tried = run_exactly(problem_, chosen->standing, progress_);
      ++out_.exact_runs;
      const JudgedRun run(problem_, tried.forces, tried.blocks);
      std::vector<Violation> violations = violations_of(run, model_.chip_m());
      if (violations.empty()) {
        Outcome outcome = outcome_of(run, model_.chip_m());
        const RobotRun robot = on_robot(run, chosen->gamma_offset_rad, outcome, violations);
        if (violations.empty()) {
          const bool learnt = model_.learn_times(robot, chosen->choice);
          Kept kept = {.chosen = std::move(*chosen),
                       .tried = std::move(tried),
                       .outcome = std::move(outcome),
                       .alternatives = out_.alternatives};
          if (!best || kept.time_s() < best->time_s()) best = std::move(kept);
          if (!learnt) break;
          continue;
        }
      }
      const Violation& first = violations.front();
      out_.reason = fmt::format("the choice was run {} times and each time broke a limit, the last time {}{}",
                                out_.exact_runs, limit_text(first), at_block(problem_, first.block));
      if (!model_.tighten(chosen->choice, violations)) break;
    }
    return best;
  }

  /// The run on the robot: its time and the greatest share of its torque that a drive gives in a line that cuts; where
  /// that is too much is a violation.
  RobotRun on_robot(const JudgedRun& run, const std::vector<double>& gamma_offset_rad, Outcome& outcome,
                    std::vector<Violation>& violations) const {
    if (!problem_.robot_run) return {};
    RobotRun out = problem_.robot_run(run.forces, run.blocks, gamma_offset_rad);
    outcome.robot_time_s = out.time_s;
    for (std::size_t i = 0; i < out.torque_shares.size(); ++i) {
      if (!model_.in_line(i)) continue;
      const double share = out.torque_shares[i];
      outcome.greatest_torque_share = std::max(outcome.greatest_torque_share, share);
      if (share > 1.0) {
        violations.push_back({{decision::ProgramLimit::joint_torque, share, 1.0}, i});
      }
    }
    return out;
  }

  /// The program as it is in place of a choice that takes the robot longer, where it keeps every limit.
  void prefer_program(Kept& found) {
    const Outcome& programmed = out_.as_programmed;
    if (!(programmed.robot_time_s < found.outcome.robot_time_s) || !programmed.violations.empty()) return;
    std::optional<ProgramDecision> choice = choice_as_it_is(problem_, model_, progress_);
    if (!choice) return;
    Chosen out = {.choice = std::move(*choice), .standing = {}, .gamma_offset_rad = {}, .miss = {}};
    out.standing.program = problem_.forces.program->program;
    out.standing.stands = joints_at(problem_.forces, out.standing.program, {});
    const std::vector<NearMiss> misses = near_misses(model_.checker(), *problem_.forces.cell, out.standing.stands);
    if (!misses.empty() && model_.posture_free()) return;
    if (!misses.empty()) out.miss = misses.front();
    out_.notes.push_back(
        fmt::format("Speeds and feeds stay as programmed: they take the robot {:.4g} s, the best choice {:.4g} s.",
                    programmed.robot_time_s, found.outcome.robot_time_s));
    found.chosen = std::move(out);
    found.tried = {.forces = problem_.forces, .blocks = problem_.blocks};
    found.outcome = programmed;
  }

  /// The best choice of those in which the robot can stand all along its way.
  std::optional<Chosen> choose() {
    for (int detour = 0; detour < most_detours; ++detour) {
      ProgramDecision choice =
          decision::decide_program(model_.cuts(), model_.stretches(), model_, model_.search(), progress_);
      out_.alternatives.clear();
      keep_alternatives(model_, choice, out_);
      if (choice.status == ProgramDecision::Status::infeasible) {
        out_.reason = infeasible_reason(problem_, model_, choice);
        if (!blocked_.empty()) out_.reason += "; left out because " + blocked_;
        return std::nullopt;
      }
      Chosen out = {.choice = std::move(choice), .standing = {}, .gamma_offset_rad = {}, .miss = {}};
      out.standing.program = model_.chosen_program(out.choice);
      out.gamma_offset_rad = model_.chosen_gamma(out.standing.program, out.choice);
      out.standing.stands = joints_at(problem_.forces, out.standing.program, out.gamma_offset_rad);
      const std::optional<std::size_t>& lost = out.standing.stands.lost;
      std::vector<NearMiss> misses;
      if (!lost) misses = near_misses(model_.checker(), *problem_.forces.cell, out.standing.stands);
      if (!misses.empty()) out.miss = misses.front();
      if (!lost && (misses.empty() || !model_.posture_free())) return out;
      leave_out(out, misses);
    }
    return std::nullopt;
  }

  /// Postures in which the robot cannot stand.
  void leave_out(const Chosen& chosen, const std::vector<NearMiss>& misses) {
    const std::optional<std::size_t>& lost = chosen.standing.stands.lost;
    out_.reason = lost ? "the robot cannot stand so" + at_block(problem_, *lost)
                       : "on its way " + cell::near_miss_text(misses.front().clearance) +
                             at_block(problem_, misses.front().block);
    if (blocked_.empty()) blocked_ = out_.reason;
    if (lost) model_.forbid(chosen.choice, *lost);
    for (const NearMiss& miss : misses) model_.forbid(chosen.choice, miss.block);
  }

  void keep(Kept& kept) {
    Chosen& chosen = kept.chosen;
    if (chosen.miss) {
      out_.collision = cell::near_miss_text(chosen.miss->clearance) + at_block(problem_, chosen.miss->block);
      out_.notes.push_back("The program as it is: " + out_.collision + ".");
    }
    out_.collisions_checked = model_.checker() != nullptr;
    out_.status = DecideResult::Status::found;
    out_.reason.clear();
    out_.decided = kept.outcome;
    out_.alternatives = std::move(kept.alternatives);
    out_.gamma_offset_rad = chosen.gamma_offset_rad;
    out_.forces = std::move(kept.tried.forces);
    out_.blocks = std::move(kept.tried.blocks);
  }

  const DecideProblem& problem_;
  Progress& progress_;
  BlockModel model_;
  DecideResult out_ = {};
  std::string blocked_ = {};  ///< why the first choice was left out in which the robot could not stand
};

}  // namespace

DecideResult decide(const DecideProblem& problem, Progress& progress) {
  check_problem(problem);
  const auto begun = std::chrono::steady_clock::now();
  DecideResult out = Decider(problem, progress).run();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace robomill::process
