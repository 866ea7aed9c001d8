#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/live/act.hpp"
#include "robomill/live/alarm_ring.hpp"
#include "robomill/live/health/load.hpp"
#include "robomill/live/health/metrics.hpp"
#include "robomill/live/hop_queue.hpp"
#include "robomill/live/notices.hpp"
#include "robomill/live/published_state.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::live {

/// Where a session delivers what it finds. All but one are called by the thread that runs it; those left empty are not.
struct SessionOutputs {
  /// The event, and its line for a file or a topic. False ends the session: nobody reads any more.
  std::function<bool(const monitor::MonitorEvent& event, const std::string& line)> event = {};
  /// @param time_s     of the stream, where the decision counts from the detector's last restart
  /// @param compute_s  that the decision took
  std::function<void(const monitor::Decision& decision, double time_s, double compute_s)> decision = {};
  std::function<void(monitor::MonitorEvent& event)> advise = {};  ///< fills in mode and better speeds of chatter
  /// Takes what a rule of [act] commands, before the event that names it. Without it events say what would be
  /// commanded.
  std::function<void(const Command& command)> command = {};
  /// Samples of whole frames after the detector took them, for a recording or a report …
  std::function<void(std::span<const float> samples)> samples = {};
  /// … and frames that were left out before the next ones: BlindReason::gap, or overloaded.
  std::function<void(std::uint64_t frames, monitor::BlindReason reason)> skipped = {};
  /// So much more time went by without samples, by the clock.
  std::function<void(double seconds)> silent = {};
  std::function<void()> idle = {};  ///< no hop came within the wait, 0.1 s at most
  /// The thread that runs the session has not gone on for Load::longest_s: State::blind, BlindReason::overloaded.
  /// Called by another thread, which must wait for nothing that the first may hold. What it says holds until the next
  /// event.
  std::function<void(const monitor::MonitorEvent& event, const std::string& line)> overloaded = {};
};

struct SessionOptions {
  bool every_window = false;  ///< an event each decision, not only on change
  bool why = false;           ///< lines of events hold why the decision is what it is
  double seconds = 0.0;       ///< of the stream, after which it ends; 0: never
  /// Samples come by the clock: where there are none for MonitorFile::timeout_s the state is blind. Of a recording
  /// none are awaited.
  bool live = false;
};

/// Processes a stream: takes hops out of a queue until that is closed, and emits decisions and events.
class ROBOMILL_API Session {
 public:
  /// @throws InvalidInput if the options of the file are out of range or the recording's folder cannot be made
  Session(const monitor::MonitorFile& file, SessionOptions options, SessionOutputs outputs);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Where inputs put their samples and report their faults.
  HopQueue& queue() { return queue_; }
  Notices& notices() { return notices_; }
  MetricValues& metrics() { return metrics_; }

  /// Until the queue is closed and empty, `stop` becomes true, the seconds are over or nobody reads.
  void run(const std::atomic<bool>& stop);
  /// What run does with each hop.
  void process(Hop&& hop);
  /// Emits what the inputs have reported. @param all  also kinds that were emitted less than a second ago
  void emit_notices(bool all = false);

  /// Frames processed, those left out among them, as time.
  [[nodiscard]] double time_s() const;
  [[nodiscard]] bool ended() const { return ended_; }

 private:
  using Clock = std::chrono::steady_clock;

  void decide(monitor::Decision decision, double compute_s);
  void check_silence(Clock::time_point now);
  void leave_out(std::uint64_t frames, bool dropped);
  void judge_load(const Hop& hop);
  void take_speed(double rad_per_s);
  void take_stall();
  void stall(double more_s, bool begins);
  void count_blind(monitor::BlindReason reason, double stream_s);
  void become_blind(monitor::BlindReason reason);
  void emit(const monitor::MonitorEvent& event);
  void emit_state(const monitor::MonitorEvent& event);
  void advise(monitor::MonitorEvent& event) const;
  void act(monitor::MonitorEvent& event);
  void begin_anew();
  void check_hint(const monitor::Decision& decision);
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
  Actor actor_;
  monitor::Decision last_;
  std::uint64_t frames_ = 0;                                           ///< processed and left out
  double base_s_ = 0.0;                                                ///< the stream's time less the detector's
  double compute_s_ = 0.0;                                             ///< since the last decision
  double speed_rad_per_s_ = std::numeric_limits<double>::quiet_NaN();  ///< that the stream carries; NaN: none
  double hint_rad_per_s_;                        ///< where it carries none: the file's, or the one commanded last
  Clock::time_point samples_at_ = Clock::now();  ///< when the last ones were processed
  double silence_s_ = 0.0;                       ///< since then, where it is longer than the timeout
  Load load_;
  PublishedState published_;
  std::atomic<double> stall_counted_s_{0.0};  ///< by the clock, of a time whose samples are not counted yet
  std::uint32_t emitted_faults_ = 0;
  double faults_emitted_s_ = -1e300, speed_known_s_ = 0.0;
  std::size_t contradicting_hops_ = 0;
  double contradicted_rad_per_s_ = 0.0;  ///< the hint that was reported
  double emitted_frequency_hz_ = 0.0, frequency_emitted_s_ = -1e300;
  bool alarm_ = false, ended_ = false;
};

}  // namespace robomill::live
