#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/fit.hpp"

// Method: robomill/jobs/README.md, "Measurements and fits"

namespace robomill::jobs {

/// FRFs to fit.
struct ModesJob {
  std::vector<std::filesystem::path> frfs;
  std::vector<std::string> as = {};  ///< their names, as modal::read_frfs takes them
  modal::FitOptions options = {};
  bool accept_fit = false;              ///< modes that do not describe the FRFs will do
  std::vector<std::string> notes = {};  ///< on the options, for the user
};

struct ModesResult {
  modal::FrfFile measured;
  modal::FitResult fit;
};

/// The modes of measured FRFs, freed of an exponential window's damping that the files still hold.
/// @throws InvalidInput as modal::read_frfs and modal::fit_modes; Interrupted
[[nodiscard]] ROBOMILL_API ModesResult run_modes(const ModesJob& job, Progress& progress = Progress::none());

/// The FRFs of fitted modes at the lines of measured ones, of those that were measured. A mass residual has no value at
/// 0 Hz, which is left out.
[[nodiscard]] ROBOMILL_API modal::FrfSet fitted_frfs(const modal::ModalModel& model, const modal::FrfSet& measured);

}  // namespace robomill::jobs
