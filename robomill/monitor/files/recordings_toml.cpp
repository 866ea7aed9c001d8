#include "robomill/monitor/files/recordings_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/monitor_tables.hpp"

namespace robomill::monitor {
namespace {

LabelledRecording read_recording(io::TomlFile& file, std::size_t index, double spindle_speed_rad_per_s) {
  const std::string row = fmt::format("recordings[{}].", index);
  LabelledRecording out;
  out.spindle_speed_rad_per_s = spindle_speed_rad_per_s;
  for (const char* key : {"file", "label"}) file.require(row + key);
  file.path(row + "file", out.file);
  file.choice<bool>(row + "label", {{"stable", false}, {"chatter", true}}, out.chatter);
  if (file.number(row + "onset_s", "onset_s", 1.0, out.onset_s)) {
    if (!out.chatter) throw file.reject(row + "onset_s", "is of chatter, and the label is \"stable\"");
    if (!(out.onset_s >= 0.0)) throw file.reject(row + "onset_s", "must be >= 0");
  }
  if (file.number(row + "spindle_speed_rpm", "spindle_speed", units::rpm, out.spindle_speed_rad_per_s) &&
      !(out.spindle_speed_rad_per_s > 0.0)) {
    throw file.reject(row + "spindle_speed_rpm", "must be > 0");
  }
  return out;
}

}  // namespace

RecordingsFile read_recordings(const io::TomlSource& source) {
  io::TomlFile file(source);
  RecordingsFile out;
  out.monitor.path = source.path;
  out.monitor.options.kind = Kind::energy_entropy;
  out.monitor.options.threshold = 0.0;  // calibration sets it
  read_signal(file, out.monitor);
  read_process(file, out.monitor);
  file.path("process.modes", out.monitor.modes);
  file.path("process.lobes", out.monitor.lobes);
  read_detector(file, out.monitor);
  if (file.number("calibration.false_alarm_rate", "false_alarm_rate", 1.0, out.false_alarm_rate) &&
      !(out.false_alarm_rate >= 0.0 && out.false_alarm_rate < 1.0)) {
    throw file.reject("calibration.false_alarm_rate", "must be at least 0 and below 1",
                      "It is the share of the stable recordings that may raise an alarm");
  }
  if (file.tables("recordings") == 0) file.require("recordings", "Write [[recordings]] above each");
  for (std::size_t i = 0; i < file.tables("recordings"); ++i) {
    out.recordings.push_back(read_recording(file, i, out.monitor.options.spindle_speed_rad_per_s));
  }
  out.monitor.notes = file.done();
  check_options(file, out.monitor);
  const auto chatters = [](const LabelledRecording& recording) { return recording.chatter; };
  for (const bool chatter : {true, false}) {
    const auto count = std::count_if(out.recordings.begin(), out.recordings.end(), chatters);
    if ((chatter ? count : static_cast<std::ptrdiff_t>(out.recordings.size()) - count) >= 2) continue;
    throw InvalidInput(
        source.path.string(),
        fmt::format("must name two recordings at least with label = \"{}\"", chatter ? "chatter" : "stable"),
        "One half of each kind sets the threshold, the other verifies it");
  }
  return out;
}

std::vector<Recording> read_samples(RecordingsFile& file, Progress& progress) {
  constexpr std::size_t block_frames = 1 << 16;
  MonitorOptions& options = file.monitor.options;
  std::vector<Recording> out;
  progress.start("recordings", file.recordings.size());
  for (const LabelledRecording& labelled : file.recordings) {
    const auto source = io::open_samples(labelled.file, file.monitor.columns);
    if (options.sample_rate_hz <= 0.0) {
      options.sample_rate_hz = source->sample_rate_hz();
      validate(file.monitor);
      file.monitor.columns.sample_rate_hz = options.sample_rate_hz;
    }
    Recording recording;
    recording.name = labelled.file.string();
    recording.chatter = labelled.chatter;
    recording.onset_s = labelled.onset_s;
    io::SampleBlock block;
    while (source->next(block_frames, block)) {
      recording.samples.insert(recording.samples.end(), block.samples.begin(), block.samples.end());
    }
    std::ranges::copy(source->notes(), std::back_inserter(file.monitor.notes));
    out.push_back(std::move(recording));
    progress.advance();
  }
  return out;
}

}  // namespace robomill::monitor
