#include "robomill/monitor/published/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/monitor/files/calibration_json.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

namespace fs = std::filesystem;
using monitor::Calibration;
using monitor::Recording;

constexpr std::size_t block_frames = 1 << 16;

/// All recordings run at one rate: that of recordings.toml, or of the first.
std::vector<Recording> read_all(monitor::RecordingsFile& file, Progress& progress) {
  monitor::MonitorOptions& options = file.monitor.options;
  std::vector<Recording> out;
  progress.start("recordings", file.recordings.size());
  for (const monitor::LabelledRecording& labelled : file.recordings) {
    const auto source = io::open_samples(labelled.file, file.monitor.columns);
    if (options.sample_rate_hz <= 0.0) {
      options.sample_rate_hz = source->sample_rate_hz();
      monitor::validate(file.monitor);
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

std::string half_text(const char* name, const monitor::CalibratedHalf& half) {
  const monitor::RocPoint& p = half.chosen;
  std::string out = fmt::format("{:<10}{:>4} stable, {:.1f} % raise a false alarm; {:>4} with chatter, {:.1f} % found",
                                name, half.stable, 100.0 * p.false_alarm_rate, half.chatter, 100.0 * p.detection_rate);
  if (std::isfinite(p.median_delay_s)) {
    out += fmt::format(", {:.0f} ms after their onset (median)", 1e3 * p.median_delay_s);
  }
  return out + "\n";
}

std::string direction(const Calibration& calibration) {
  return fmt::format("{} entropy {} {:.6g}", monitor::to_string(calibration.options.entropy),
                     calibration.options.alarm_below ? "below" : "above", calibration.options.threshold);
}

std::string summary_of(const Calibration& calibration) {
  std::string out = fmt::format("Chatter is {}.\n", direction(calibration));
  out += half_text("setting", calibration.setting) + half_text("verifying", calibration.verifying);
  if (std::isfinite(calibration.median_lead_s)) {
    out += fmt::format(
        "The alarm comes {:.0f} ms before the line is seen in the spectrogram (median of the verifying half).\n",
        1e3 * calibration.median_lead_s);
  }
  return out;
}

}  // namespace

Exit run(const CalibrateCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::toml}, "a calibrated detector is written as .toml");
  require_report_place(command.report);
  monitor::RecordingsFile file = monitor::read_recordings(command.recordings);
  const std::vector<Recording> recordings = read_all(file, progress);
  const Calibration calibration = monitor::calibrate(recordings, file.monitor.options,
                                                     {.false_alarm_rate = file.false_alarm_rate, .seed = common.seed});
  const std::string json = monitor::calibration_json(calibration);
  if (common.to_stdout()) {
    fmt::print("{}", json);
  } else if (!common.output.empty()) {
    monitor::MonitorFile monitor = file.monitor;
    monitor.options = calibration.options;
    monitor.modes = from_folder_of(common.output, monitor.modes);
    monitor.lobes = from_folder_of(common.output, monitor.lobes);
    const monitor::RocPoint& verified = calibration.verifying.chosen;
    io::write_file(
        common.output,
        monitor::monitor_toml(
            monitor,
            fmt::format("robomill calibrate {}: {} recordings, half of them to verify.\n"
                        "Verified: {:.1f} % of the cuts with chatter found, {:.1f} % of the stable ones raise a "
                        "false alarm.",
                        command.recordings.filename().string(), recordings.size(), 100.0 * verified.detection_rate,
                        100.0 * verified.false_alarm_rate)));
  }
  if (!command.report.empty()) {
    page::Report page;
    page.title = "Calibration of the chatter monitor";
    page.summary = summary_of(calibration);
    page.calibration = json;
    write_report(command.report, page, json);
  }
  if (common.wants_summary()) fmt::print("{}", summary_of(calibration));
  return calibration.verifying.chosen.detection_rate > 0.0 ? done : not_reached;
}

}  // namespace robomill::app
