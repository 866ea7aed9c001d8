#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/live/recorded_run.hpp"

// Method: robomill/live/README.md, "Method"

namespace robomill::live {

/// A recorded run for its report: curves as `low` and `high` over runs of equal length. docs/formats.md, "Events".
/// @throws InvalidInput if an event is no JSON
[[nodiscard]] ROBOMILL_API std::string recorded_run_json(const RecordedRun& run);

}  // namespace robomill::live
