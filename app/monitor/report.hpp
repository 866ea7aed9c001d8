#pragma once
#include <filesystem>
#include <string>

#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/page/report.hpp"

namespace robomill::app {

/// The page of a recorded session. @param source  a file or an address
[[nodiscard]] page::Report monitor_page(live::RecordedRun run, const monitor::MonitorFile& file,
                                        const std::string& source);

/// @throws InvalidInput unless the path is empty or ends in .json or .html
void check_report_place(const std::filesystem::path& path);
/// As JSON or as a page, by the ending.
void write_report(const std::filesystem::path& path, const page::Report& page);

}  // namespace robomill::app
