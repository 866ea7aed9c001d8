#include "robomill/jobs/plan_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/process/written_program.hpp"
#include "robomill/version.hpp"

namespace robomill::jobs {
namespace {

bool leans(const process::Decision& decision) {
  return std::ranges::any_of(decision.stretches, [](const process::DecidedLines& lines) {
    return lines.lead_rad != 0.0 || lines.tilt_rad != 0.0;
  });
}

bool turns(const process::Decision& decision) {
  return std::ranges::any_of(decision.gamma_offset_rad, [](double turn) { return turn != 0.0; });
}

/// What of a decided program was looked at for collisions.
enum class Checked { block_ends, trajectory };

std::string checked_text(const PlanResult& result, Checked checked) {
  const bool smoothed = checked == Checked::trajectory;
  const std::optional<process::SmoothResult>& path = result.decided->path;
  if (smoothed && path->smoothed.clearance) {
    const path::PathClearance& way = *path->smoothed.clearance;
    return fmt::format("The whole trajectory was checked against the cell's geometry: {}{}", path::clearance_text(way),
                       way.covers_moves() ? "" : ". That is too far to exclude a collision between them");
  }
  if (!smoothed && result.decision->collisions_checked) {
    return "Checked against the cell's geometry was the way from block end to block end with every joint running "
           "evenly, "
           "no trajectory";
  }
  return "Nothing was checked for collisions: the cell has no [geometry]";
}

std::vector<std::string> header_of(const PlanResult& result, Checked checked) {
  const process::Decision& decision = *result.decision;
  std::vector<std::string> out = {
      fmt::format("Spindle speeds and feeds by robomill {}, from {}", ROBOMILL_VERSION,
                  result.job.program.filename().string()),
      fmt::format("{} changes of S, {} of F. Least stability margin {:.2f}, cutting time at the feeds {:.4g} s",
                  decision.speeds_changed, decision.feeds_changed, decision.decided->least_stability_margin,
                  decision.decided->cutting_time_s)};
  std::string path = leans(decision)
                         ? "The tool leans otherwise than in the program as it was, about the centre of its "
                           "ball. "
                         : "Tool axes are those of the program as it was. ";
  if (turns(decision)) path += "The flange turns about the tool otherwise: the trajectory has it. ";
  if (decision.compensation) {
    path += fmt::format("Finishing passes are moved by up to {:.3g} mm against the deflection that is predicted. ",
                        decision.compensation->largest_offset_m / units::mm);
  }
  out.push_back(path + checked_text(result, checked));
  return out;
}

/// As the blocks were numbered: as the smoothed path read them, where there is one.
program::ProgramReading reading_of(const PlanResult& result, const cell::Cell& cell) {
  return result.programmed.path ? result.programmed.path->reading : cell::program_reading(cell);
}

std::string program_name(const Job& job) {
  return "program" + job.program.extension().string();
}

const program::Program& program_of(const PlannedProgram& planned) {
  return planned.forces->program->program;
}

void write_program(PlanResult& result, const cell::Cell& cell, Checked checked) {
  result.decided->text =
      program::rewrite_program(result.job.program, reading_of(result, cell), program_of(result.programmed),
                               program_of(*result.decided), header_of(result, checked));
}

process::ProgrammedPath programmed_path(const PlanResult& result) {
  return {.path = *result.programmed.path, .program = program_of(result.programmed), .file = result.job.program};
}

/// What watches the program while it runs: the modes of the block that is nearest to chatter.
monitor::PlannedMonitor monitor_of(const PlanResult& result, const process::DynamicsAt& dynamics) {
  const DecidedProgram& decided = *result.decided;
  const program::Program& program = program_of(decided);
  monitor::MonitorPlan plan = {.teeth = decided.forces->cut.cutter.mill.teeth};
  for (const process::DecidedLines& lines : result.decision->stretches) {
    plan.speeds.push_back({.spindle_speed_rad_per_s = lines.spindle_speed_rad_per_s,
                           .line = static_cast<int>(program.blocks[lines.first_block].line)});
  }
  const std::size_t worst = decided.blocks->worst;
  plan.modes = dynamics(decided.forces->program->blocks[worst].joints).modes;
  plan.modes_line = static_cast<int>(program.blocks[worst].line);
  return plan_monitor(plan);
}

/// No trajectory of a program that is not to be run.
void withdraw(process::SmoothResult& path) {
  path.trajectory.reset();
  path.smoothed.written = false;
  std::error_code ignored;
  path.stale = !path.output.empty() && std::filesystem::is_regular_file(path.output, ignored);
}

/// What is known once the decided program is smoothed: its time, whether its way is free, and what watches it.
void finish_decided(PlanResult& result, const process::DynamicsAt& dynamics) {
  DecidedProgram& decided = *result.decided;
  if (decided.path) result.decision->decided->robot_time_s = decided.path->first().summary.duration_s;
  const std::string& collision = result.decision->collision;
  const bool strikes = decided.path && !decided.path->clear();
  if (collision.empty() && !strikes) {
    decided.monitor = monitor_of(result, dynamics);
    return;
  }
  decided.text.reset();
  if (decided.path) withdraw(*decided.path);
  if (!strikes) result.warnings.push_back("There is no program: on its way " + collision + ".");
}

/// A spindle that a robot program switches on by an output runs at one speed: the one that its drive is set to.
void take_one_speed(const cell::Cell& cell, process::DecideOptions& options, PlanResult& result) {
  if (options.speed_changes == process::SpeedChanges::none) return;
  if (!options.speed_changes_given) {
    options.speed_changes = process::SpeedChanges::none;
    result.assumed.push_back({.what = "Changes of the spindle's speed",
                              .taken = "none: spindle.output of the cell only switches the spindle on",
                              .key = "decide.speed_changes",
                              .file = result.job.file.filename().string()});
    return;
  }
  result.notes.push_back(
      fmt::format("decide.speed_changes allows several spindle speeds; a robot program carries out one, since "
                  "spindle.output of {} only switches the spindle on.",
                  cell.path.filename().string()));
}

}  // namespace

void decide_conditions(PlanResult& result, const cell::Cell& cell, const process::DynamicsAt& dynamics,
                       const process::BlocksOptions& blocks, const std::filesystem::path& folder, Progress& progress) {
  process::DecideProblem problem = {.forces = *result.programmed.forces,
                                    .blocks = *result.programmed.blocks,
                                    .dynamics = dynamics,
                                    .blocks_options = blocks,
                                    .machine = result.job.recommend,
                                    .finish = result.job.finish,
                                    .options = result.job.decide};
  if (cell.end_effector.spindle.given() && problem.options.is_free(process::Free::spindle_speed)) {
    take_one_speed(cell, problem.options, result);
  }
  std::optional<process::SmoothResult>& before = result.programmed.path;
  if (before) {
    problem.max_tip_speed_m_per_s = before->smoothing.options.max_velocity_m_per_s;
    problem.robot_run = [&](const process::ForcesResult& run, const process::ProgramBlocks& judged,
                            const std::vector<double>& gamma_offset_rad) {
      return process::run_on_robot(programmed_path(result), cell, {run, gamma_offset_rad}, judged, progress);
    };
  }
  process::DecideResult found = process::decide(problem, progress);
  if (found.forces) {
    result.decided.emplace();
    result.decided->forces = std::move(found.forces);
    result.decided->blocks = std::move(found.blocks);
    result.decided->name = program_name(result.job);
  }
  result.decision = static_cast<process::Decision&&>(found);
  if (result.decided) {
    write_program(result, cell, Checked::block_ends);
    if (before) {
      const std::filesystem::path output = folder.empty() ? folder : folder / "trajectory.csv";
      result.decided->path = process::smooth_written(
          programmed_path(result), cell, {*result.decided->forces, result.decision->gamma_offset_rad},
          {.name = result.decided->name, .text = result.decided->text->text, .output = output}, progress);
      write_program(result, cell, Checked::trajectory);  // the same lines, whose head says what was checked
    }
    finish_decided(result, dynamics);
  }
  if (before) withdraw(*before);
}

}  // namespace robomill::jobs
