#pragma once
#include <array>
#include <filesystem>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/cutting/files/force_record.hpp"
#include "robomill/cutting/measured_force.hpp"

// Method: robomill/process/README.md, "Forces (`forces.hpp`)"

namespace robomill::process {

struct ForcesResult;

/// A force record beside the revolution of a result, in the sign that the result is reported with.
struct MeasuredRevolution {
  std::filesystem::path path = {};
  std::array<std::string, 3> channels = {};  ///< columns that are x, y, z; "none"
  cutting::MeasuredForce force;
};

/// How the record is laid over the prediction (MeasuredForceOptions).
struct RecordStretch {
  double speed_tolerance = cutting::MeasuredForceOptions{}.speed_tolerance;
  double from_s = 0.0, to_s = cutting::MeasuredForceOptions{}.to_s;
};

/// Compares the revolution of a result with a record, and adds it with its notes and what it assumes. With vibration it
/// is the vibrating tool's last revolution.
/// @throws InvalidInput as cutting::compare_forces, with the record's file or the cut's; where the result has no
/// revolution
ROBOMILL_API void compare_with_record(ForcesResult& result, const cutting::ForceRecordFile& record,
                                      const RecordStretch& stretch = {});

}  // namespace robomill::process
