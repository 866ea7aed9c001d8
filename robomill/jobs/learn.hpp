#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/monitor/machine.hpp"

// Method: robomill/monitor/README.md, "Machines that were learnt"

namespace robomill::jobs {

struct LearnResult {
  monitor::Machine machine;
  std::vector<std::string> notes = {};  ///< sentences for the user
};

/// Learns a machine from recordings without chatter, read block by block, with the channels, speed and teeth of
/// monitor.toml. All run at one rate: that of the file, else the first one's. A machine that the file names is left
/// out, and may be missing.
/// @throws InvalidInput with file and time where a recording seems to contain chatter, if none is given or one is
///     unreadable, as monitor::read_monitor, or as monitor::MachineLearner
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API LearnResult run_learn(const std::filesystem::path& monitor_toml,
                                                 const std::vector<std::filesystem::path>& recordings,
                                                 Progress& progress = Progress::none());

}  // namespace robomill::jobs
