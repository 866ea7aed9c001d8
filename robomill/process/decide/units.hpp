#pragma once
#include <cstddef>
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

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
  /// … and the first at whose end the tool may lean as in it: the longest of the rapids that lead to it; 0 of the
  /// first.
  std::vector<std::size_t> lean_from = {};
};

/// Way of the tip up to the program's start and up to each block's end: a value more than blocks.
[[nodiscard]] std::vector<double> ways_m(const program::Program& program);

/// Way of the tip over blocks [first, last].
[[nodiscard]] double way_m(const program::Program& program, std::size_t first, std::size_t last);

/// Whether the tool runs down along its axis by more than 30° in some block of this one's line.
[[nodiscard]] bool plunges_in_line(const program::Program& program, std::size_t block);

/// @param at_speeds  stretches end where the spindle changes its speed too
[[nodiscard]] ProgramUnits program_units(const ForcesResult& forces, const ProgramBlocks& blocks, bool at_speeds);

/// The same lines and stretches in another run of the program's blocks, with their ways and what cuts there.
/// @param forces  with cuts kept
[[nodiscard]] ProgramUnits units_again(const ProgramUnits& units, const ForcesResult& forces);

}  // namespace robomill::process
