#include "robomill/jobs/plan_decision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks/stand_at.hpp"
#include "robomill/jobs/decide/joint_torques.hpp"
#include "robomill/jobs/decide/motion_loads.hpp"
#include "robomill/jobs/files/scratch_program.hpp"
#include "robomill/jobs/program_forces.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/version.hpp"

namespace robomill::jobs {
namespace {

bool leans(const DecideResult& decision) {
  return std::ranges::any_of(decision.stretches,
                             [](const DecidedLines& lines) { return lines.lead_rad != 0.0 || lines.tilt_rad != 0.0; });
}

bool turns(const DecideResult& decision) {
  return std::ranges::any_of(decision.gamma_offset_rad, [](double turn) { return turn != 0.0; });
}

std::vector<std::string> header_of(const PlanResult& result) {
  const DecideResult& decision = *result.decision;
  std::vector<std::string> out = {
      fmt::format("Spindle speeds and feeds by robomill {}, from {}", ROBOMILL_VERSION,
                  result.job.program.filename().string()),
      fmt::format("{} changes of S, {} of F. Least stability margin {:.2f}, cutting time {:.4g} s",
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
  if (!decision.collision.empty()) {
    path += "CAUTION: " + decision.collision;
  } else {
    path += decision.collisions_checked ? "The way was checked against the cell's geometry"
                                        : "Nothing was checked for collisions";
  }
  out.push_back(std::move(path));
  return out;
}

/// As the blocks were numbered: as the smoothed path read them, where there is one.
program::ProgramReading reading_of(const PlanResult& result, const CellFile& cell) {
  return result.path ? result.path->reading : program_reading(cell);
}

void write_program(PlanResult& result, const CellFile& cell) {
  result.program_out =
      program::rewrite_program(result.job.program, reading_of(result, cell), result.forces->program->program,
                               *result.decision->program, header_of(result));
  result.program_name = "program" + result.job.program.extension().string();
}

/// Where the machine starts and how the flange stands along a program, turned by γ from where it was along the one that
/// was smoothed.
path::Posture posture_of(const SmoothResult& smoothed, const program::Program& program,
                         const std::vector<double>& gamma_offset_rad, const CellFile& cell) {
  const path::Posture& before = smoothed.posture.posture;
  if (gamma_offset_rad.empty() && before.gamma_rad.size() <= 1) return before;
  path::Posture out;
  for (std::size_t i = 0; i <= program.blocks.size(); ++i) {
    const double gamma = before.gamma_rad.size() > 1    ? before.gamma_rad.at(i)
                         : before.gamma_rad.size() == 1 ? before.gamma_rad.front()
                                                        : cell.redundant_gamma_rad;
    out.gamma_rad.push_back(gamma + (gamma_offset_rad.empty() ? 0.0 : gamma_offset_rad[i]));
  }
  const program::Pose& start = program.start;
  const std::optional<Eigen::VectorXd> joints =
      stand_at(cell.cell, spherical_wrist(cell.cell.arm),
               {.tip_m = start.tip_m, .axis = start.axis, .gamma_rad = out.gamma_rad.front()}, before.start);
  if (!joints) {
    throw InvalidInput("gamma", out.gamma_rad.front() / units::deg, "°", "cannot be taken where the program starts");
  }
  out.start = *joints;
  return out;
}

/// The decided program as the robot will run it.
void smooth_decided(PlanResult& result, const CellFile& cell, const std::filesystem::path& folder, Progress& progress) {
  const DecideResult& decision = *result.decision;
  const ScratchProgram file(folder, result.program_name, result.program_out->text);
  SmoothJob job = {.program = file.path(),
                   .cell = cell.path,
                   .place = false,
                   .program_name = result.program_name,
                   .posture = posture_of(*result.path, *decision.program, decision.gamma_offset_rad, cell)};
  if (!folder.empty()) job.output = folder / "trajectory.csv";
  result.path = run_smooth(job, cell, progress);
}

/// A program that was run and judged, turned by γ.
struct TurnedRun {
  const ForcesResult& forces;
  const ProgramBlocks& blocks;
  const std::vector<double>& gamma_rad;
};

/// What the drives give while the robot runs a program, by the trajectory that it would be smoothed to.
std::vector<double> torque_shares(const PlanResult& result, const CellFile& cell, const std::filesystem::path& folder,
                                  const TurnedRun& run, Progress& progress) {
  const std::string name = "program" + result.job.program.extension().string();
  const program::Rewritten text = program::rewrite_program(
      result.job.program, reading_of(result, cell), result.forces->program->program, run.forces.program->program);
  const ScratchProgram file(folder, name, text.text);
  MotionLoads loads(cell, result.path->options.sample_period_s);
  const SmoothJob job = {.program = file.path(),
                         .cell = cell.path,
                         .record = false,
                         .place = false,
                         .program_name = name,
                         .posture = posture_of(*result.path, run.forces.program->program, run.gamma_rad, cell),
                         .observe = [&loads](std::span<const path::Sample> samples) { loads.add(samples); }};
  static_cast<void>(run_smooth(job, cell, progress));
  return loads.shares(run.forces, joint_torques(run.forces, run.blocks));
}

/// What watches the program while it runs: the modes of the block that is nearest to chatter.
PlannedMonitor monitor_of(const PlanResult& result, const DynamicsAt& dynamics) {
  const program::Program& program = *result.decision->program;
  MonitorPlan plan = {.teeth = result.forces->file.cutter.mill.teeth};
  for (const DecidedLines& lines : result.decision->stretches) {
    plan.speeds.push_back({.spindle_speed_rad_per_s = lines.spindle_speed_rad_per_s,
                           .line = static_cast<int>(program.blocks[lines.first_block].line)});
  }
  const std::size_t worst = result.blocks->worst;
  plan.modes = dynamics(result.forces->program->blocks[worst].joints).modes;
  plan.modes_line = static_cast<int>(program.blocks[worst].line);
  return plan_monitor(plan);
}

/// No trajectory of a program that is not to be run.
void withdraw(SmoothResult& path) {
  path.trajectory.reset();
  path.smoothed.written = false;
  std::error_code ignored;
  path.stale = !path.output.empty() && std::filesystem::is_regular_file(path.output, ignored);
}

}  // namespace

void decide_conditions(PlanResult& result, const CellFile& cell, const DynamicsAt& dynamics,
                       const BlocksOptions& blocks, const std::filesystem::path& folder, Progress& progress) {
  DecideProblem problem = {.forces = *result.forces,
                           .blocks = *result.blocks,
                           .dynamics = dynamics,
                           .blocks_options = blocks,
                           .machine = result.job.recommend,
                           .finish = result.job.finish,
                           .options = result.job.decide};
  if (result.path) {
    problem.max_tip_speed_m_per_s = result.path->options.max_velocity_m_per_s;
    if (knows_torques(cell)) {
      problem.torque_shares = [&](const ForcesResult& run, const ProgramBlocks& judged,
                                  const std::vector<double>& gamma_offset_rad) {
        return torque_shares(result, cell, folder, {.forces = run, .blocks = judged, .gamma_rad = gamma_offset_rad},
                             progress);
      };
    }
  }
  result.decision = decide(problem, progress);
  if (result.decision->status != DecideResult::Status::found) {
    if (result.path) withdraw(*result.path);
    return;
  }
  write_program(result, cell);
  if (result.path) smooth_decided(result, cell, folder, progress);
  result.forces = *std::exchange(result.decision->forces, std::nullopt);
  result.blocks = *std::exchange(result.decision->blocks, std::nullopt);
  result.monitor = monitor_of(result, dynamics);
}

}  // namespace robomill::jobs
