#include "robomill/jobs/calibrate.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"

namespace robomill::jobs {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t block_frames = 1 << 16;

/// All recordings run at one rate: that of recordings.toml, or of the first.
std::vector<monitor::Recording> read_all(monitor::RecordingsFile& file, Progress& progress) {
  monitor::MonitorOptions& options = file.monitor.options;
  std::vector<monitor::Recording> out;
  progress.start("recordings", file.recordings.size());
  for (const monitor::LabelledRecording& labelled : file.recordings) {
    const auto source = io::open_samples(labelled.file, file.monitor.columns);
    if (options.sample_rate_hz <= 0.0) {
      options.sample_rate_hz = source->sample_rate_hz();
      monitor::validate(file.monitor);
      file.monitor.columns.sample_rate_hz = options.sample_rate_hz;
    }
    monitor::Recording recording;
    recording.name = labelled.file.string();
    recording.chatter = labelled.chatter;
    recording.onset_s = labelled.onset_s;
    io::SampleBlock block;
    while (source->next(block_frames, block)) {
      recording.samples.insert(recording.samples.end(), block.samples.begin(), block.samples.end());
    }
    out.push_back(std::move(recording));
    progress.advance();
  }
  return out;
}

/// Relative to the folder of the file that names it.
fs::path from_folder_of(const fs::path& file, const fs::path& named) {
  if (named.empty()) return named;
  return fs::proximate(fs::absolute(named), fs::absolute(file).parent_path());
}

}  // namespace

CalibrateResult run_calibrate(const fs::path& recordings, std::uint64_t seed, Progress& progress) {
  monitor::RecordingsFile file = monitor::read_recordings(recordings);
  const std::vector<monitor::Recording> samples = read_all(file, progress);
  CalibrateResult out;
  out.calibration =
      monitor::calibrate(samples, file.monitor.options, {.false_alarm_rate = file.false_alarm_rate, .seed = seed});
  out.monitor = std::move(file.monitor);
  out.monitor.options = out.calibration.options;
  return out;
}

std::string calibrated_toml(const CalibrateResult& result, const fs::path& place) {
  monitor::MonitorFile file = result.monitor;
  file.modes = from_folder_of(place, file.modes);
  file.lobes = from_folder_of(place, file.lobes);
  const monitor::RocPoint& verified = result.calibration.verifying.chosen;
  return monitor::monitor_toml(
      file, fmt::format("robomill calibrate {}: {} recordings, half of them to verify.\n"
                        "Verified: {:.1f} % of the cuts with chatter found, {:.1f} % of the stable ones raise a "
                        "false alarm.",
                        file.path.filename().string(), result.calibration.alarms.size(),
                        100.0 * verified.detection_rate, 100.0 * verified.false_alarm_rate));
}

}  // namespace robomill::jobs
