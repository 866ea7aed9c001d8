#include "robomill/jobs/plan_decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/monitor_plan.hpp"
#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/decide/block_times.hpp"
#include "robomill/process/decide/motion_loads.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"
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

/// A program as its text says it, for a robot that is to run it.
class WrittenProgram {
 public:
  WrittenProgram(const std::string& name, const std::string& text, const program::ProgramReading& reading,
                 const program::Program& wanted)
      : wanted_(wanted), read_(program::read_program_text(text, name, reading)) {
    // A move that turns the tool may be read as several blocks, and rapids that run on as fewer.
    std::size_t next = 0;
    for (const program::Block& block : read_.blocks) {
      std::size_t k = next;
      while (k + 1 < wanted.blocks.size() && !same_end(block, wanted.blocks[k]) &&
             wanted.blocks[k].kind == program::Block::Kind::rapid) {
        ++k;
      }
      const bool ends = same_end(block, wanted.blocks[k]);
      block_of_.push_back(ends ? k : next);
      if (ends) next = std::min(k + 1, wanted.blocks.size() - 1);
    }
  }
  /// As it is read.
  [[nodiscard]] const program::Program& read() const { return read_; }
  /// Of each block that is read the one that was wanted.
  [[nodiscard]] const std::vector<std::size_t>& block_of() const { return block_of_; }
  /// Of values at the wanted program's start and at each block's end those of the program that is read.
  [[nodiscard]] std::vector<double> along(const std::vector<double>& wanted) const {
    std::vector<double> out = {wanted.front()};
    for (std::size_t i = 0; i < read_.blocks.size(); ++i) {
      const std::size_t k = block_of_[i];
      const Eigen::Vector3d& from_m = wanted_.begin_of(k).tip_m;
      const double way_m = (wanted_.blocks[k].end.tip_m - from_m).norm();
      const bool part = way_m > 0.0 && !same_end(read_.blocks[i], wanted_.blocks[k]);
      const double share = part ? std::min((read_.blocks[i].end.tip_m - from_m).norm() / way_m, 1.0) : 1.0;
      out.push_back(std::lerp(wanted[k], wanted[k + 1], share));
    }
    return out;
  }

 private:
  static bool same_end(const program::Block& a, const program::Block& b) {
    constexpr double same_m = 1e-6, same_axis = 1e-6;
    return a.kind == b.kind && (a.end.tip_m - b.end.tip_m).norm() <= same_m &&
           (a.end.axis - b.end.axis).norm() <= same_axis;
  }
  const program::Program& wanted_;
  program::Program read_;
  std::vector<std::size_t> block_of_ = {};
};

/// Where the machine starts and how the flange stands along a program, turned by γ from where it was along the one that
/// was smoothed.
path::Posture posture_of(const process::SmoothResult& smoothed, const WrittenProgram& written,
                         const program::Program& program, const std::vector<double>& gamma_offset_rad,
                         const cell::Cell& cell) {
  const path::Posture& before = smoothed.posture.posture;
  path::Posture out = before;
  if (out.gamma_rad.empty()) out.gamma_rad = {cell.redundant_gamma_rad};
  if (!gamma_offset_rad.empty() || out.gamma_rad.size() > 1) {
    out.gamma_rad.resize(program.blocks.size() + 1, out.gamma_rad.front());
    for (std::size_t i = 0; i < gamma_offset_rad.size(); ++i) out.gamma_rad[i] += gamma_offset_rad[i];
    out.gamma_rad = written.along(out.gamma_rad);
  }
  const std::optional<Eigen::VectorXd> joints = process::stand_at(
      cell.cell, robot::spherical_wrist(cell.cell.arm),
      {.tip_m = program.start.tip_m, .axis = program.start.axis, .gamma_rad = out.gamma_rad.front()}, before.start);
  if (!joints) {
    throw InvalidInput("gamma", out.gamma_rad.front() / units::deg, "°", "cannot be taken where the program starts");
  }
  out.start = *joints;
  return out;
}

/// The decided program as the robot will run it.
void smooth_decided(PlanResult& result, const cell::Cell& cell, const std::filesystem::path& folder,
                    Progress& progress) {
  const process::SmoothResult& before = *result.programmed.path;
  DecidedProgram& decided = *result.decided;
  const program::Program& wanted = program_of(decided);
  const WrittenProgram written(decided.name, decided.text->text, reading_of(result, cell), wanted);
  process::SmoothOptions options = {
      .place = false,
      .posture = posture_of(before, written, wanted, result.decision->gamma_offset_rad, cell),
      .cutter = decided.forces->cut.cutter};
  if (!folder.empty()) options.output = folder / "trajectory.csv";
  program::ProgramSource source(written.read());
  decided.path = process::smooth(source, decided.name, cell, before.smoothing, options, progress);
}

/// A program that was run and judged, turned by γ.
struct TurnedRun {
  const process::ForcesResult& forces;
  const process::ProgramBlocks& blocks;
  const std::vector<double>& gamma_rad;
};

/// What the robot makes of a program, by the trajectory that it would be smoothed to.
process::RobotRun robot_run(const PlanResult& result, const cell::Cell& cell, const TurnedRun& run,
                            Progress& progress) {
  const program::Program& program = run.forces.program->program;
  const std::string name = program_name(result.job);
  const program::ProgramReading reading = reading_of(result, cell);
  const program::Rewritten text =
      program::rewrite_program(result.job.program, reading, program_of(result.programmed), program);
  const WrittenProgram written(name, text.text, reading, program);
  const process::SmoothResult& before = *result.programmed.path;
  const path::SmoothingFile& smoothing = before.smoothing;
  std::optional<process::MotionLoads> loads;
  if (process::knows_torques(cell)) loads.emplace(cell, smoothing.options.sample_period_s, written.block_of());
  process::BlockTimes times(written.block_of());
  const process::SmoothOptions options = {.record = false,
                                          .place = false,
                                          .posture = posture_of(before, written, program, run.gamma_rad, cell),
                                          .check_collisions = false,
                                          .observe = [&](std::span<const path::Sample> samples) {
                                            times.add(samples);
                                            if (loads) loads->add(samples);
                                          }};
  program::ProgramSource source(written.read());
  const process::SmoothResult smoothed = process::smooth(source, name, cell, smoothing, options, progress);
  process::RobotRun out = {
      .time_s = smoothed.first().summary.duration_s, .block_time_s = times.times_s(), .torque_shares = {}};
  if (loads) out.torque_shares = loads->shares(run.forces, run.blocks.joint_loads);
  return out;
}

/// What watches the program while it runs: the modes of the block that is nearest to chatter.
PlannedMonitor monitor_of(const PlanResult& result, const process::DynamicsAt& dynamics) {
  const DecidedProgram& decided = *result.decided;
  const program::Program& program = program_of(decided);
  MonitorPlan plan = {.teeth = decided.forces->cut.cutter.mill.teeth};
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
      return robot_run(result, cell, {.forces = run, .blocks = judged, .gamma_rad = gamma_offset_rad}, progress);
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
    if (before) smooth_decided(result, cell, folder, progress);
    if (before) write_program(result, cell, Checked::trajectory);  // the same lines, whose head says what was checked
    finish_decided(result, dynamics);
  }
  if (before) withdraw(*before);
}

}  // namespace robomill::jobs
