#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/jobs/forces.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::jobs {

/// None for an arm that has no spherical wrist.
[[nodiscard]] std::optional<robot::SphericalWristInverse> spherical_wrist(const robot::Arm& arm);

/// How a program is run.
struct ProgramRun {
  std::optional<program::Program> program = {};         ///< none: read from its file
  std::optional<program::ProgramReading> reading = {};  ///< none: the cell's
  std::vector<robot::Position6> joints = {};            ///< at the end of each block; none: found here
  bool keep_cuts = false;                               ///< ProgramForces::cuts
  bool deflect = false;  ///< the engagement feels the deflection, with a cell and a stock; else it does not
};

/// Joints at the end of every block.
/// @throws InvalidInput with file and line where a block is out of the robot's reach
[[nodiscard]] std::vector<robot::Position6> joints_along(const CellFile& file, const program::Program& program,
                                                         const std::filesystem::path& path);

/// Fills what the forces of a block do to the robot where it stands (BlockResult::joints): deflections and condition
/// number. Not regular: the deflections from there on are left as they are.
[[nodiscard]] robot::Stiffness::Status bend_block(const robot::Cell& cell, BlockResult& row);

/// run_forces of a program that is run so.
[[nodiscard]] ForcesResult run_forces_with(ForcesFile forces, const std::filesystem::path& program,
                                           std::optional<CellFile> cell, const ProgramRun& run, Progress& progress);

/// Forces along a program, and the robot under them where there is a cell.
/// @throws InvalidInput with file and line, also where a block is out of the robot's reach; Interrupted
[[nodiscard]] ProgramForces run_program(const ForcesFile& file, const std::optional<CellFile>& cell,
                                        const std::filesystem::path& program, std::vector<std::string>& warnings,
                                        std::vector<std::string>& notes, Progress& progress,
                                        const ProgramRun& run = {});

}  // namespace robomill::jobs
