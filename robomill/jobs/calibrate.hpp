#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/monitor/calibration.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"

// Method: robomill/jobs/README.md, "Calibrated detectors (`calibrate.hpp`)"

namespace robomill::jobs {

struct CalibrateResult {
  monitor::Calibration calibration;
  monitor::MonitorFile monitor;  ///< recordings.toml's, with the calibrated options
  [[nodiscard]] bool found() const { return calibration.status == monitor::Calibration::Status::found; }
};

/// Reads recordings.toml and all its recordings, which run at one rate (the file's, else the first one's), and sets the
/// published detector's threshold with them: monitor::calibrate.
/// @param seed  of the split into halves
/// @throws InvalidInput with file, line, key and value of recordings.toml, as monitor::read_samples, or as
///     monitor::calibrate
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API CalibrateResult run_calibrate(const std::filesystem::path& recordings, std::uint64_t seed,
                                                         Progress& progress = Progress::none());

/// The calibrated detector as monitor.toml, under a remark on the share of alarms when verified.
/// @param place  where the text is to stand: its paths are relative to that folder
/// @throws InvalidInput if the calibration's status is not found: that is no detector
[[nodiscard]] ROBOMILL_API std::string calibrated_toml(const CalibrateResult& result,
                                                       const std::filesystem::path& place);

}  // namespace robomill::jobs
