#pragma once
#include <string>

#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/page/report.hpp"

namespace robomill::app {

/// The page of a recorded session. @param source  a file or an address
[[nodiscard]] page::Report monitor_page(live::RecordedRun run, const monitor::MonitorFile& file,
                                        const std::string& source);

/// Where chatter may be folded, for how long the session was in each state, and why it could not tell: a line each.
[[nodiscard]] std::string run_summary(const live::RecordedRun& run);

}  // namespace robomill::app
