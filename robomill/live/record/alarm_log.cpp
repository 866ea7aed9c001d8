#include "robomill/live/record/alarm_log.hpp"

#include <algorithm>

namespace robomill::live {
namespace {

constexpr std::size_t most_rows = 100;
constexpr double pause_s = 10.0;     ///< an alarm so much later is no repetition
constexpr double same_ratio = 0.05;  ///< frequencies nearer than that are about the same
constexpr int most_strays = 4;       ///< so many decisions in a row at another frequency are no misreading

/// Whether the frequency is among those of the row or near them: one that drifts takes its range with it.
bool fits(const RecordedAlarm& alarm, double frequency_hz) {
  if (std::isnan(frequency_hz) || std::isnan(alarm.low_frequency_hz)) return true;
  return frequency_hz > alarm.low_frequency_hz / (1.0 + same_ratio) &&
         frequency_hz < alarm.high_frequency_hz * (1.0 + same_ratio);
}

}  // namespace

std::optional<std::size_t> AlarmLog::row_for(double time_s, double frequency_hz) {
  for (std::size_t i = rows_.size(); i-- > 0;) {
    if (time_s - rows_[i].alarm.to_s <= pause_s && fits(rows_[i].alarm, frequency_hz)) return i;
  }
  if (rows_.size() == most_rows) return std::nullopt;
  rows_.emplace_back().alarm = {.from_s = time_s, .to_s = time_s};
  return rows_.size() - 1;
}

void AlarmLog::end(double time_s) {
  if (row_) {
    RecordedAlarm& alarm = rows_[*row_].alarm;
    alarm.chatter_s += std::max(0.0, time_s - last_s_);
    alarm.to_s = std::max(alarm.to_s, time_s);
  }
  row_.reset();
  alarm_ = false;
}

void AlarmLog::add(const monitor::Decision& decision, const std::vector<std::string>& channels) {
  const double time_s = decision.time_s;
  const std::optional<std::size_t> before = row_;
  const bool lasted = alarm_;
  end(time_s);
  last_s_ = time_s;
  if (decision.state != monitor::State::chatter) return;
  alarm_ = true;
  row_ = before;
  if (!lasted) ++count_;
  const double frequency_hz = decision.chatter_frequency_hz > 0.0 ? decision.chatter_frequency_hz : NAN;
  if (!row_ || !fits(rows_[*row_].alarm, frequency_hz)) {
    if (row_ && ++strays_ < most_strays) return;
    row_ = row_for(time_s, frequency_hz);
    if (!row_ && !lasted) ++unlisted_;
  }
  strays_ = 0;
  if (!row_) return;
  Row& row = rows_[*row_];
  if (row.last != count_) ++row.alarm.count;
  row.last = count_;
  row.note(decision, channels);
}

void AlarmLog::add(const monitor::MonitorEvent& event) {
  if (!row_ || event.kind != monitor::MonitorEvent::Kind::state) return;
  if (fits(rows_[*row_].alarm, event.decision.chatter_frequency_hz)) rows_[*row_].advise(event);
}

std::vector<RecordedAlarm> AlarmLog::alarms() const {
  std::vector<RecordedAlarm> out;
  for (const Row& row : rows_) {
    out.push_back(row.alarm);
    if (std::isinf(out.back().chatter_frequency_std_hz)) out.back().chatter_frequency_std_hz = NAN;
  }
  return out;
}

double AlarmLog::highest_hz() const {
  double out = 0.0;
  for (const Row& row : rows_) out = std::fmax(out, row.alarm.high_frequency_hz);
  return out;
}

}  // namespace robomill::live
