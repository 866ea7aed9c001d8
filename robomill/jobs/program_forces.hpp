#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/jobs/forces.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::jobs {

/// None for an arm that has no spherical wrist.
[[nodiscard]] std::optional<robot::SphericalWristInverse> spherical_wrist(const robot::Arm& arm);

/// Forces along a program, and the robot under them where there is a cell.
/// @throws InvalidInput with file and line, also where a block is out of the robot's reach; Interrupted
[[nodiscard]] ProgramForces run_program(const ForcesFile& file, const std::optional<CellFile>& cell,
                                        const std::filesystem::path& program, std::vector<std::string>& warnings,
                                        std::vector<std::string>& notes, Progress& progress);

}  // namespace robomill::jobs
