#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "alarm_ring.hpp"
#include "hop_queue.hpp"
#include "metrics.hpp"
#include "notices.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/report/monitor_recorder.hpp"

namespace robomill::app {

/// Who learns what a session hears. All are called by the thread that runs it; those left empty are not.
struct SessionOutputs {
  /// The event, and its line for a file or a topic. False ends the session: nobody reads any more.
  std::function<bool(const monitor::MonitorEvent& event, const std::string& line)> event = {};
  std::function<void(const monitor::Decision& decision, double time_s)> decision = {};
  std::function<void(monitor::MonitorEvent& event)> advise = {};  ///< fills in mode and better speeds of chatter
  report::MonitorRecorder* recorder = nullptr;                    ///< gathers what a report shows
};

struct SessionOptions {
  bool every_window = false;  ///< an event each decision, not only on change
  double seconds = 0.0;       ///< of the stream, after which it ends; 0: never
};

/// Hears a stream: takes hops out of a queue until that is closed, and tells decisions and events.
class Session {
 public:
  /// @throws InvalidInput if the options of the file are out of range or the recording's folder cannot be made
  Session(const monitor::MonitorFile& file, SessionOptions options, SessionOutputs outputs);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Where inputs put their samples and their complaints.
  HopQueue& queue() { return queue_; }
  Notices& notices() { return notices_; }
  MetricValues& metrics() { return metrics_; }

  /// Until the queue is closed and empty, `stop` becomes true, the seconds are over or nobody reads.
  void run(const std::atomic<bool>& stop);
  /// Hears one hop: what run does with each.
  void hear(Hop&& hop);
  /// Tells what the inputs have complained about. @param all  also what was told less than a second ago
  void tell_notices(bool all = false);

  /// Frames heard, those left out among them, as time.
  [[nodiscard]] double time_s() const;
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  void decide(monitor::Decision decision, double compute_s);
  void tell(monitor::MonitorEvent event);
  [[nodiscard]] bool fault_is_news(const monitor::Decision& decision);
  [[nodiscard]] bool frequency_is_news(const monitor::Decision& decision);

  monitor::MonitorFile file_;
  SessionOptions options_;
  SessionOutputs outputs_;
  monitor::ChatterMonitor monitor_;
  HopQueue queue_;
  Notices notices_;
  MetricValues metrics_;
  std::optional<AlarmRing> ring_;
  monitor::Decision last_;
  std::uint64_t frames_ = 0;  ///< heard and left out
  double base_s_ = 0.0;       ///< the stream's time less the detector's
  double compute_s_ = 0.0;    ///< since the last decision
  double speed_rad_per_s_ = 0.0;
  std::uint32_t told_faults_ = 0;
  double faults_told_s_ = -1e300, speed_known_s_ = 0.0;
  double told_frequency_hz_ = 0.0, frequency_told_s_ = -1e300;
  bool alarm_ = false, ended_ = false;
};

}  // namespace robomill::app
