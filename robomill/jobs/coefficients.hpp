#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/files/force_record.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/process/measured.hpp"

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

struct SignalCoefficientsJob {
  std::filesystem::path record;  ///< force record of one steady cut
  std::filesystem::path cut;     ///< forces.toml of that cut; its [coefficients] may be missing
  cutting::ForceRecordOptions reading = {};
  process::RecordStretch stretch = {};
  int degree = 0;  ///< of the cutting coefficients as polynomials in κ, 0 to 6; edge coefficients are constants
};

struct SignalCoefficientsResult {
  cutting::SignalFit fit;
  std::filesystem::path record;
  /// Why they are not to be used: they explain less than half of the force's variance, or no cut has them (a negative
  /// tangential one). Empty: they may be.
  std::string rejected = {};
  /// The cut with the coefficients found, and the record beside it. Without a revolution where they are rejected.
  process::ForcesResult forces;
  std::vector<Assumption> assumed = {};
};

/// Cutting force coefficients from the force record of one cut, by cutting::identify_from_signal on its mean
/// revolution.
/// @throws InvalidInput with file, line, key and value, or as read_force_record, compare_forces and
/// identify_from_signal; where a component was not measured
[[nodiscard]] ROBOMILL_API SignalCoefficientsResult run_signal_coefficients(const SignalCoefficientsJob& job);

}  // namespace robomill::jobs
