#pragma once
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"

/// What the files of a job leave to the usual case, with what else is assumed of them. Nothing of files that were built
/// in memory.
namespace robomill::jobs {

/// What of a cut counts.
enum class CutUse {
  stability,  ///< its stiffness alone
  motion      ///< its forces too, as of a simulation or of the surface that it leaves
};
[[nodiscard]] std::vector<Assumption> assumed_of(const LobesFile& file, CutUse use);

/// @param with_cell  a cell is there, whoever names it
[[nodiscard]] std::vector<Assumption> assumed_of(const process::ForcesFile& file, bool with_cell);

}  // namespace robomill::jobs
