#pragma once
#include <filesystem>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/jobs/README.md, "Measurements and fits"

namespace robomill::jobs {

struct FrfJobResult {
  modal::HitsFile file;  ///< with its records
  modal::FrfResult frfs;
};

/// The FRFs of the hits that hits.toml names.
/// @throws InvalidInput as modal::read_hits and modal::estimate_frfs; Interrupted
[[nodiscard]] ROBOMILL_API FrfJobResult run_frf(const std::filesystem::path& hits,
                                                Progress& progress = Progress::none());

}  // namespace robomill::jobs
