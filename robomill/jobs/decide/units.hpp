#pragma once
#include <cstddef>
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/jobs/blocks.hpp"
#include "robomill/jobs/forces.hpp"

namespace robomill::jobs {

/// A line of the program that cuts: its blocks, and those of them that cut.
struct LineUnit {
  std::size_t first_block = 0, last_block = 0;
  std::vector<std::size_t> cutting = {};
  bool turns_only = false;  ///< the tip stands: its feed is an angle, and stays
};

/// The lines that cut and the stretches between rapid moves.
struct ProgramUnits {
  std::vector<LineUnit> lines = {};
  std::vector<decision::ProgramCut> cuts = {};  ///< one a line; without looks
  std::vector<decision::ProgramStretch> stretches = {};
  /// Of each stretch the first block that may run at its speed: the rapid that leads to it; 0 of the first.
  std::vector<std::size_t> speed_from = {};
};

[[nodiscard]] ProgramUnits program_units(const ForcesResult& forces, const ProgramBlocks& blocks);

}  // namespace robomill::jobs
