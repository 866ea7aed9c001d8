#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/live/recorded_run.hpp"

namespace robomill::live {

[[nodiscard]] const io::Schema<RecordedRun>& recorded_run_table();
/// A recorded run for its report: curves as `low` and `high` over runs of equal length. docs/formats.md, "Events".
/// @throws InvalidInput if an event is no JSON
[[nodiscard]] ROBOMILL_API std::string recorded_run_json(const RecordedRun& run);

}  // namespace robomill::live
