#pragma once
#include <array>
#include <vector>

#include "robomill/process/decide.hpp"
#include "robomill/robot/joint_load.hpp"

namespace robomill::process {

/// A program that was run and judged, with what its joints bear.
struct JudgedRun {
  JudgedRun(const DecideProblem& asked, const ForcesResult& run, const ProgramBlocks& judged);

  const DecideProblem& problem;
  const ForcesResult& forces;
  const ProgramBlocks& blocks;
  std::vector<robot::LoadedBlock> torques;
  std::vector<robot::LoadReversal> reversals;
};

/// Loads that a lower feed lowers.
[[nodiscard]] bool rises_with_feed(decision::ProgramLimit limit);

/// Magnitude of what a block leaves of the finished surface; without a stock of all that it leaves. NaN: nothing, or
/// not known.
[[nodiscard]] double left_surface_error_m(const ForcesResult& forces, const BlockRow& row);

/// Every violation, block by block.
/// @param chip_m  greatest chip thickness, least and most
[[nodiscard]] std::vector<Violation> violations_of(const JudgedRun& run, const std::array<double, 2>& chip_m);
/// What the program comes to, with the worst violation of each limit.
[[nodiscard]] Outcome outcome_of(const JudgedRun& run, const std::array<double, 2>& chip_m);

}  // namespace robomill::process
