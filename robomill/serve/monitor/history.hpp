#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/live/record/lasting_alarm.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// What a session had to say: each stay in chatter, each in which nothing could be said, and the faults of its
/// samples, of which those of a kind that follow each other are one row.
class MonitorHistory {
 public:
  static constexpr std::size_t most_rows = 500, most_changed = 20;
  /// @param channels     their names
  /// @param alarm_below  MonitorOptions': a lower score is worse
  MonitorHistory(std::vector<std::string> channels, bool alarm_below)
      : channels_(std::move(channels)), alarm_below_(alarm_below) {}

  /// Every decision. @param clock_s  since the session's beginning
  void add(const monitor::Decision& decision, double time_s, double clock_s);
  /// Every event, after its decision: what was advised, that no samples come, faults of the stream.
  /// @param message  MonitorEvent's, as a client may see it
  void add(const monitor::MonitorEvent& event, const std::string& message, double clock_s);
  /// The stream is over.
  void end(double time_s);

  /// The last rows, newest first.
  [[nodiscard]] io::Json rows() const;
  /// The newest of those that changed and were not taken yet, newest first; the others come the next time.
  [[nodiscard]] io::Json take_changed();

 private:
  struct Row {
    enum class Kind { chatter, blind, notice };
    Kind kind = Kind::notice;
    std::uint64_t number = 0;  ///< from 1
    double clock_s = 0.0;
    monitor::BlindReason reason = monitor::BlindReason::none;
    double score = NAN;                   ///< the worst
    live::LastingAlarm lasting = {};      ///< begin and end; of chatter what is known of it; of notices their count
    std::string what = {}, message = {};  ///< of notices
    bool changed = true;
    [[nodiscard]] io::Json json() const;
  };
  Row& begin(Row row, double from_s);
  /// The row of what lasts; none where nothing does.
  [[nodiscard]] Row* lasting(monitor::State state, monitor::BlindReason reason, double time_s, double clock_s);
  [[nodiscard]] Row* open_row();
  void note(Row& row, const monitor::Decision& decision) const;

  std::vector<std::string> channels_;
  bool alarm_below_;
  std::deque<Row> rows_;
  std::uint64_t last_ = 0, open_ = 0;  ///< numbers; 0: none
};

}  // namespace robomill::serve
