#pragma once
#include <filesystem>
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/simulation/simulation.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/jobs/README.md, "A cut in time (`simulate.hpp`)"

namespace robomill::jobs {

/// A cut of lobes.toml at one speed and depth.
struct SimulateJob {
  io::TomlSource lobes;             ///< lobes.toml
  stability::OperatingPoint point;  ///< of drilling the depth is the lips' radial width, from the pilot hole to the rim
  simulation::SimulationOptions options = {};
};

struct SimulateResult {
  LobesFile cut;                                       ///< with modes in the place of FRFs; its notes are for the user
  stability::OperatingPoint point;                     ///< that the job asks for
  std::optional<modal::FitResult> fit, workpiece_fit;  ///< of a file that names FRFs
  simulation::Simulation simulation;
};

/// Simulates a milling or drilling cut. A simulation steps modes: where the file names FRFs, those of the hybrid fit
/// over all their lines.
/// @throws InvalidInput with file, line, key and value, or if the modes do not describe the FRFs; Interrupted
[[nodiscard]] ROBOMILL_API SimulateResult run_simulate(const SimulateJob& job, Progress& progress = Progress::none());

}  // namespace robomill::jobs
