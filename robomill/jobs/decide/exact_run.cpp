#include "robomill/jobs/decide/exact_run.hpp"

#include <utility>

#include "robomill/jobs/program_forces.hpp"

namespace robomill::jobs {

ForcesResult run_again(const DecideProblem& problem, const StandingProgram& standing, Progress& progress) {
  const ForcesResult& before = problem.forces;
  const ProgramRun run = {.program = standing.program,
                          .joints = standing.stands.joints,
                          .keep_cuts = true,
                          .deflect = before.program->deflected};
  ForcesFile file = before.file;
  if (problem.options.is_free(Free::spindle_speed)) file.motion.spindle_speed_rad_per_s = 0.0;  // the program's own
  if (before.program->stock) file.stock = before.program->stock->stock;  // not one about a moved path
  return run_forces_with(std::move(file), before.program->path, before.cell, run, progress);
}

Tried run_exactly(const DecideProblem& problem, const StandingProgram& standing, Progress& progress) {
  Tried out = {.forces = run_again(problem, standing, progress), .blocks = {}};
  BlocksOptions options = problem.blocks_options;
  options.scan_points = 0;
  out.blocks = judge_blocks(out.forces, problem.dynamics, options, progress);
  return out;
}

}  // namespace robomill::jobs
