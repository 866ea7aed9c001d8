#pragma once
#include <filesystem>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/files/slots_csv.hpp"

// Method: robomill/jobs/README.md, "Measurements and fits"

namespace robomill::jobs {

struct CoefficientsJob {
  std::filesystem::path slots;  ///< slots.csv
  int teeth = 0;                ///< of the cutter; 0: not said, and 4 are assumed
};

struct CoefficientsResult {
  cutting::SlotsFile file;
  cutting::SlotFit fit;
  std::vector<Assumption> assumed = {};
};

/// Cutting force coefficients from mean forces of slots.
/// @throws InvalidInput with file, line, column and value, or as cutting::identify_from_slots
[[nodiscard]] ROBOMILL_API CoefficientsResult run_coefficients(const CoefficientsJob& job);

}  // namespace robomill::jobs
