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
  bool plunges = false;  ///< the tool runs down along its axis by more than 30°: it is fed no faster than programmed
};

/// The lines that cut and the stretches between rapid moves.
struct ProgramUnits {
  std::vector<LineUnit> lines = {};
  std::vector<decision::ProgramCut> cuts = {};  ///< one a line; without looks
  std::vector<decision::ProgramStretch> stretches = {};
  /// Of each stretch the first block that may run at its speed: the rapid that leads to it; 0 of the first.
  std::vector<std::size_t> speed_from = {};
};

/// @param at_speeds  stretches end where the spindle changes its speed too
[[nodiscard]] ProgramUnits program_units(const ForcesResult& forces, const ProgramBlocks& blocks, bool at_speeds);

}  // namespace robomill::jobs
