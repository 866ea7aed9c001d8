#pragma once
// The tables of monitor.toml, of which recordings.toml has the first three, and those of recordings.toml.
#include "robomill/io/schema.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"

namespace robomill::monitor {

/// [signal], [process] and [detector].
[[nodiscard]] const io::Schema<MonitorFile>& signal_table();
[[nodiscard]] const io::Schema<MonitorFile>& process_table();
[[nodiscard]] const io::Schema<MonitorOptions>& detector_table();
/// [mqtt], [act], [metrics] and [recording].
[[nodiscard]] const io::Schema<MqttSettings>& mqtt_table();
[[nodiscard]] const io::Schema<ActSettings>& act_table();
[[nodiscard]] const io::Schema<MonitorFile>& metrics_table();
[[nodiscard]] const io::Schema<MonitorFile>& recording_table();

/// [calibration] and [[recordings]].
[[nodiscard]] const io::Schema<RecordingsFile>& calibration_options_table();
[[nodiscard]] const io::Schema<LabelledRecording>& labelled_recording_table();

/// [signal], [process] and [detector].
void read_detection(io::TomlFile& file, MonitorFile& out);
/// @throws InvalidInput in the words of the file
void check_options(const io::TomlFile& file, const MonitorFile& monitor);

}  // namespace robomill::monitor
