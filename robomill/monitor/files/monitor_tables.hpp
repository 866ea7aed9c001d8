#pragma once
// What monitor.toml and recordings.toml share; not for other folders.
#include <string>

#include "robomill/io/toml/file.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::monitor {

/// A column's name, or its number from 1.
[[nodiscard]] bool read_column(io::TomlFile& file, const std::string& key, std::string& out);
/// [signal], [process] and [detector].
void read_signal(io::TomlFile& file, MonitorFile& out);
void read_process(io::TomlFile& file, MonitorFile& out);
void read_detector(io::TomlFile& file, MonitorFile& out);
/// @throws InvalidInput in the words of the file
void check_options(const io::TomlFile& file, const MonitorFile& monitor);

}  // namespace robomill::monitor
