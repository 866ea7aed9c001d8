#pragma once
#include <string>
#include <vector>

#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/page/report.hpp"

namespace robomill::app {

/// The unit in which the names of all channels of vibration end: "m/s²" of "ax_m_per_s2", "g" of "ax_g"; otherwise
/// empty.
/// @param tachometer_channel  MonitorOptions'
[[nodiscard]] std::string unit_of(const std::vector<std::string>& channels, int tachometer_channel);

/// The page of a recorded session. @param source  a file or an address
[[nodiscard]] page::Report monitor_page(live::RecordedRun run, const monitor::MonitorFile& file,
                                        const std::string& source);

/// Where chatter may be folded, for how long the session was in each state, and why it could not tell: a line each.
[[nodiscard]] std::string run_summary(const live::RecordedRun& run);

}  // namespace robomill::app
