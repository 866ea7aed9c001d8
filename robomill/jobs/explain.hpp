#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/peak_classification.hpp"

// Method: robomill/jobs/README.md, "Peaks of a cut (`explain.hpp`)"

namespace robomill::jobs {

/// Measured peaks, the modes that may chatter, and the cut if it is known.
struct ExplainJob {
  stability::MeasuredPeaks peaks;
  stability::PeakClassificationOptions options = {};
  std::filesystem::path modes;           ///< of the tool: modes.json or .toml
  std::filesystem::path lobes = {};      ///< lobes.toml of the cut; empty: the cut is unknown
  stability::OperatingPoint point = {};  ///< of the cut
};

struct ExplainResult {
  stability::PeakClassification peaks;
  int teeth = 0;                                              ///< of the cutter, as the job has them
  std::vector<std::string> notes = {};                        ///< on the modes, for the user
  std::optional<LobesFile> cut = {};                          ///< with its dynamics
  std::optional<stability::ChatterMechanism> mechanism = {};  ///< whether the cut's chatter needs the delay
};

/// What the peaks of a cut are, and, where the cut is known, whether its chatter is regenerative. The workpiece's modes
/// are those of the cut.
/// @throws InvalidInput with file, line, key and value, or as stability::explain and stability::chatter_mechanism
[[nodiscard]] ROBOMILL_API ExplainResult run_explain(const ExplainJob& job);

}  // namespace robomill::jobs
