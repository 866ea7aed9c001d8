#pragma once
#include <filesystem>
#include <span>

#include "robomill/base/progress.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/machine.hpp"

namespace robomill::monitor {

/// Learns a machine from recordings without chatter, read block by block. All run at one rate: that of monitor.toml,
/// else the first one's, which is then the file's. What is remarkable of one, such as that it was cut, becomes a note
/// of the file.
/// @throws InvalidInput with file and time where a recording seems to contain chatter, if none is given, as validate,
///     io::open_samples and SampleSource::next, or as MachineLearner
/// @throws Interrupted when progress asks to stop
[[nodiscard]] Machine learn_recordings(MonitorFile& file, std::span<const std::filesystem::path> recordings,
                                       Progress& progress = Progress::none());

}  // namespace robomill::monitor
