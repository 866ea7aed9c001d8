#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/cell/cell.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/process/smooth.hpp"

namespace robomill::process {

/// A program as it is, with the trajectory that it was smoothed to.
struct ProgrammedPath {
  const SmoothResult& path;
  const program::Program& program;
  std::filesystem::path file;  ///< with its text
};

/// It at other conditions, which its text is to state, with γ as of Decision::gamma_offset_rad.
struct WantedProgram {
  const ForcesResult& forces;  ///< along it
  const std::vector<double>& gamma_offset_rad;
};

/// What the robot makes of it, by the trajectory that it would be smoothed to: without a record or a check for
/// collisions.
/// @throws InvalidInput as program::rewrite_program and smooth; Interrupted
[[nodiscard]] RobotRun run_on_robot(const ProgrammedPath& programmed, const cell::Cell& cell,
                                    const WantedProgram& wanted, const ProgramBlocks& blocks, Progress& progress);

struct WrittenText {
  std::string name = {};  ///< of its file
  const std::string& text;
  std::filesystem::path output = {};  ///< of the trajectory; empty: none
};
/// It as the robot will run it, from its text.
/// @throws InvalidInput as smooth; Interrupted
[[nodiscard]] SmoothResult smooth_written(const ProgrammedPath& programmed, const cell::Cell& cell,
                                          const WantedProgram& wanted, const WrittenText& written, Progress& progress);

}  // namespace robomill::process
