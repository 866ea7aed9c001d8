#pragma once
#include <filesystem>

#include "robomill/process/forces.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::process {

/// Fills what the forces of a block do to the robot where it stands (BlockResult::joints): deflections and condition
/// number. Not regular: the deflections from there on are left as they are.
[[nodiscard]] robot::Stiffness::Status bend_block(const robot::Cell& cell, BlockResult& row);

/// @throws InvalidInput unless they are along a program, with a cell and the cut of each block
void require_cuts(const ForcesResult& forces);

/// Runs a program through the material.
/// @param result  with cut, and cell if there is one; its program, warnings and notes are filled
/// @throws InvalidInput as forces_along; Interrupted
void run_program(ForcesResult& result, program::Program program, const std::filesystem::path& path,
                 const ProgramRun& run, Progress& progress);

}  // namespace robomill::process
