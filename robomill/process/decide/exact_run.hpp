#pragma once
#include "robomill/process/blocks.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"

namespace robomill::process {

/// A program with the same blocks as the problem's, and where the robot stands at the end of each.
struct StandingProgram {
  program::Program program;
  Stands stands;
};

/// The program's run through the problem's stock.
[[nodiscard]] ForcesResult run_again(const DecideProblem& problem, const StandingProgram& standing, Progress& progress);

/// The same, and every block judged.
struct Tried {
  ForcesResult forces;
  ProgramBlocks blocks;
};
[[nodiscard]] Tried run_exactly(const DecideProblem& problem, const StandingProgram& standing, Progress& progress);

}  // namespace robomill::process
