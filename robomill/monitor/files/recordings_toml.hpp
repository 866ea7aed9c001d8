#pragma once
#include <filesystem>
#include <limits>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/monitor/calibration.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

namespace robomill::monitor {

/// A recording with its label: chatter or stable.
struct LabelledRecording {
  std::vector<std::filesystem::path> files;  ///< one, or several with the channels apart
  bool chatter = false;
  double onset_s = std::numeric_limits<double>::quiet_NaN();  ///< of chatter [s]; NaN: unknown
  double spindle_speed_rad_per_s = 0.0;                       ///< [rad/s]; 0: unknown
};

/// recordings.toml: what to calibrate a detector with.
struct RecordingsFile {
  MonitorFile monitor;             ///< its [signal], [process] and [detector]
  double false_alarm_rate = 0.05;  ///< share of the stable recordings that may raise an alarm, in [0, 1)
  std::vector<LabelledRecording> recordings = {};
};

/// @throws InvalidInput with file, line, key and value, also where no recording chatters or none is stable
[[nodiscard]] RecordingsFile read_recordings(const io::TomlSource& source);

/// The samples of the labelled recordings, in their order. All run at one rate: that of recordings.toml, else the first
/// one's, which is then the file's. What is remarkable of one, such as that it was cut, becomes a note of the file.
/// @throws InvalidInput as io::open_samples and SampleSource::next
/// @throws Interrupted when progress asks to stop
[[nodiscard]] std::vector<Recording> read_samples(RecordingsFile& file, Progress& progress = Progress::none());

}  // namespace robomill::monitor
