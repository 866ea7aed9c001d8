#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::live {

/// Takes what a session is given and what it reports, and keeps what a page shows of it, in memory that does not grow
/// with the recording: waves, score and spectrogram over runs that grow twice as long when there are too many, states,
/// and alarms, those that repeat put together.
class ROBOMILL_API Recorder {
 public:
  /// @param channels  their names, as many as the options say
  /// @throws InvalidInput if an option is out of range or the names do not fit
  Recorder(const monitor::MonitorOptions& options, std::vector<std::string> channels, std::string unit);
  ~Recorder();
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Whole frames, as they went to the monitor; NaN and infinite samples are absent.
  void add(std::span<const float> samples);
  /// Frames that were left out: of their time nothing is known, for this reason.
  void skip(std::uint64_t frames, monitor::BlindReason reason = monitor::BlindReason::gap);
  /// So much more time went by without samples, by the clock: BlindReason::no_signal, as that of frames which turn out
  /// to have been left out then.
  void silent(double seconds);
  /// The decision that followed. Its time is that of the stream, frames that were left out counted.
  /// @param compute_s  it took so long
  void add(const monitor::Decision& decision, double compute_s);
  /// An event that it reported; beyond some hundreds they are only counted.
  void add(const monitor::MonitorEvent& event);

  /// What was recorded so far; facts and warnings are left to the caller.
  [[nodiscard]] RecordedRun run() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::live
