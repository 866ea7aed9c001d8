#include "robomill/monitor/files/recordings_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/joined_records.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/monitor_tables.hpp"

namespace robomill::monitor {
namespace {

constexpr Name<bool> labels[] = {{"stable", false}, {"chatter", true}};

}  // namespace

const io::Schema<RecordingsFile>& calibration_options_table() {
  static const io::Schema<RecordingsFile> table(
      "calibration", "how the threshold is chosen",
      {io::key("false_alarm_rate", &RecordingsFile::false_alarm_rate,
               "share of the stable recordings that may raise an alarm")
           .at_least(0.0)
           .below(1.0, "It is the share of the stable recordings that may raise an alarm")});
  return table;
}

const io::Schema<LabelledRecording>& labelled_recording_table() {
  static const io::Schema<LabelledRecording> table(
      "recordings",
      "recordings of which it is known whether they hold chatter; at least two of each: half of them verify",
      {io::declared<LabelledRecording>("file", io::Holds::path, "a recording; a list of files where channels are apart",
                                       1)
           .or_one()
           .required()
           .read_by([](io::TomlFile& file, const std::string& path, LabelledRecording& out) {
             io::read_record_files(file, path, out.files);
           }),
       io::key("label", &LabelledRecording::chatter, labels, "what it holds").required(),
       io::key("onset_s", &LabelledRecording::onset_s, "of chatter, where it is known").at_least(0.0),
       io::key("spindle_speed_rpm", &LabelledRecording::spindle_speed_rad_per_s, "in place of the process'")
           .above(0.0)});
  return table;
}

RecordingsFile read_recordings(const io::TomlSource& source) {
  io::TomlFile file(source);
  RecordingsFile out;
  out.monitor.path = source.path;
  out.monitor.options.kind = Kind::energy_entropy;
  out.monitor.options.threshold = 0.0;  // calibration sets it
  read_detection(file, out.monitor);
  calibration_options_table().read(file, "calibration", out);
  if (file.tables("recordings") == 0) file.require("recordings", "Write [[recordings]] above each");
  for (std::size_t i = 0; i < file.tables("recordings"); ++i) {
    const std::string row = fmt::format("recordings[{}]", i);
    LabelledRecording& recording = out.recordings.emplace_back();
    recording.spindle_speed_rad_per_s = out.monitor.options.spindle_speed_rad_per_s;
    labelled_recording_table().read(file, row, recording);
    if (!recording.chatter && file.has(row + ".onset_s")) {
      throw file.reject(row + ".onset_s", "is of chatter, and the label is \"stable\"");
    }
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
    const auto source = io::open_samples(labelled.files, file.monitor.columns);
    if (options.sample_rate_hz <= 0.0) {
      options.sample_rate_hz = source->sample_rate_hz();
      validate(file.monitor);
      file.monitor.columns.sample_rate_hz = options.sample_rate_hz;
    }
    Recording recording;
    for (const std::filesystem::path& part : labelled.files)
      recording.name += (recording.name.empty() ? "" : " + ") + part.string();
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
