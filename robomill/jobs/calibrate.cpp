#include "robomill/jobs/calibrate.hpp"

#include <fmt/format.h>

#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"

namespace robomill::jobs {
namespace {

namespace fs = std::filesystem;

/// Relative to the folder of the file that names it.
fs::path from_folder_of(const fs::path& file, const fs::path& named) {
  if (named.empty()) return named;
  return fs::proximate(fs::absolute(named), fs::absolute(file).parent_path());
}

}  // namespace

CalibrateResult run_calibrate(const fs::path& recordings, std::uint64_t seed, Progress& progress) {
  monitor::RecordingsFile file = monitor::read_recordings(recordings);
  const std::vector<monitor::Recording> samples = monitor::read_samples(file, progress);
  CalibrateResult out;
  out.calibration =
      monitor::calibrate(samples, file.monitor.options, {.false_alarm_rate = file.false_alarm_rate, .seed = seed});
  out.monitor = std::move(file.monitor);
  out.monitor.options = out.calibration.options;
  return out;
}

std::string calibrated_toml(const CalibrateResult& result, const fs::path& place) {
  if (!result.found()) {
    throw InvalidInput("calibration", "is none: " + monitor::reason(result.calibration));
  }
  monitor::MonitorFile file = result.monitor;
  file.modes = from_folder_of(place, file.modes);
  file.lobes = from_folder_of(place, file.lobes);
  file.machine = from_folder_of(place, file.machine);
  const monitor::RocPoint& verified = result.calibration.verifying.chosen;
  return monitor::monitor_toml(
      file, fmt::format("robomill calibrate {}: {} recordings, half of them to verify.\n"
                        "Verified: {:.1f} % of the cuts with chatter found, {:.1f} % of the stable ones raise a "
                        "false alarm.",
                        file.path.filename().string(), result.calibration.alarms.size(),
                        100.0 * verified.detection_rate, 100.0 * verified.false_alarm_rate));
}

}  // namespace robomill::jobs
