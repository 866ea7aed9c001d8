#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/report/monitor.hpp"

// Method: robomill/report/README.md, "Method"

namespace robomill::report {

/// Takes what a monitor is given and what it says, and keeps what a report shows of it, in memory that does not grow
/// with the recording: waves, score and spectrogram over runs that grow twice as long when there are too many.
class ROBOMILL_API MonitorRecorder {
 public:
  /// @param channels  their names, as many as the options say
  /// @throws InvalidInput if an option is out of range or the names do not fit
  MonitorRecorder(const monitor::MonitorOptions& options, std::vector<std::string> channels, std::string unit);
  ~MonitorRecorder();
  MonitorRecorder(MonitorRecorder&&) noexcept;
  MonitorRecorder& operator=(MonitorRecorder&&) noexcept;
  MonitorRecorder(const MonitorRecorder&) = delete;
  MonitorRecorder& operator=(const MonitorRecorder&) = delete;

  /// Whole frames, as they went to the monitor.
  void add(std::span<const float> samples);
  /// Frames that were left out: drawn as zeros, of a long gap a minute.
  void skip(std::uint64_t frames);
  /// The decision that followed.
  /// @param compute_s  it took so long
  void add(const monitor::Decision& decision, double compute_s);
  /// An event that it reported; beyond some hundreds they are only counted.
  void add(const monitor::MonitorEvent& event);

  /// What was recorded so far; facts and warnings are left to the caller.
  [[nodiscard]] MonitorRun run() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::report
