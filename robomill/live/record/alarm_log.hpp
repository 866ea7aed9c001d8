#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/live/record/lasting_alarm.hpp"
#include "robomill/live/recorded_run.hpp"
#include "robomill/monitor/files/monitor_events.hpp"

namespace robomill::live {

/// The alarms of a run, those that repeat put together.
class AlarmLog {
 public:
  /// Every decision, those without an alarm too.
  /// @param channels  their names
  void add(const monitor::Decision& decision, const std::vector<std::string>& channels);
  /// What was advised on the alarm that lasts.
  void add(const monitor::MonitorEvent& event);
  /// An alarm lasts no longer than this: nothing is known of what follows.
  void end(double time_s);

  [[nodiscard]] std::vector<RecordedAlarm> alarms() const;
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Alarms that are in none of the rows.
  [[nodiscard]] std::size_t unlisted() const { return unlisted_; }
  /// The highest frequency of all rows [Hz]; 0: none.
  [[nodiscard]] double highest_hz() const;

 private:
  struct Row : LastingAlarm {
    std::size_t last = 0;  ///< number of the last alarm counted
  };
  /// The row that this decision belongs to; none where there are too many.
  [[nodiscard]] std::optional<std::size_t> row_for(double time_s, double frequency_hz);

  std::vector<Row> rows_;
  std::optional<std::size_t> row_;  ///< of the alarm that lasts
  bool alarm_ = false;              ///< one lasts
  int strays_ = 0;                  ///< decisions in a row whose frequency is not the row's
  std::size_t count_ = 0, unlisted_ = 0;
  double last_s_ = 0.0;
};

}  // namespace robomill::live
