#pragma once
#include <filesystem>
#include <vector>

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

/// The FRFs of the hits that hits.toml names, or of records of hits.
/// @param inputs  one hits.toml, or records alone (modal::read_bare_hits)
/// @throws InvalidInput as modal::read_hits, modal::read_bare_hits and modal::estimate_frfs; Interrupted
[[nodiscard]] ROBOMILL_API FrfJobResult run_frf(const std::vector<std::filesystem::path>& inputs,
                                                Progress& progress = Progress::none());

}  // namespace robomill::jobs
