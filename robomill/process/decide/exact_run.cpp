#include "robomill/process/decide/exact_run.hpp"

#include <utility>

namespace robomill::process {

ForcesResult run_again(const DecideProblem& problem, const StandingProgram& standing, Progress& progress) {
  const ForcesResult& before = problem.forces;
  const ProgramRun run = {.joints = standing.stands.joints, .keep_cuts = true, .deflect = before.program->deflected};
  Cut cut = before.cut;
  if (problem.options.is_free(Free::spindle_speed)) cut.motion.spindle_speed_rad_per_s = 0.0;  // the program's own
  if (before.program->stock) cut.stock = before.program->stock->stock;  // not one about a moved path
  return forces_along(std::move(cut), standing.program, before.program->path, before.cell, run, progress);
}

Tried run_exactly(const DecideProblem& problem, const StandingProgram& standing, Progress& progress) {
  Tried out = {.forces = run_again(problem, standing, progress), .blocks = {}};
  BlocksOptions options = problem.blocks_options;
  options.scan_points = 0;
  out.blocks = judge_blocks(out.forces, problem.dynamics, options, progress);
  return out;
}

}  // namespace robomill::process
