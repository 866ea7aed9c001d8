#pragma once
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

// Method: robomill/jobs/README.md, "Method"

namespace robomill::jobs {

/// What the files that monitor.toml names say of the cut: modes, and lobes, whose chart is computed.
/// @throws InvalidInput  if a file is missing or wrong, modes come without teeth, or as monitor::validate
/// @throws Interrupted   when progress asks to stop
[[nodiscard]] ROBOMILL_API live::AdviceBasis read_advice_basis(const monitor::MonitorFile& file, Progress& progress);

}  // namespace robomill::jobs
