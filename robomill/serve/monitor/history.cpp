#include "robomill/serve/monitor/history.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"
#include "robomill/monitor/files/explanation_schema.hpp"

namespace robomill::serve {
namespace {

using io::Json;

constexpr std::array<const char*, 3> row_kinds = {"chatter", "blind", "notice"};
constexpr std::size_t longest_message = 300;

Json text_or_null(std::string_view text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

}  // namespace

Json MonitorHistory::Row::json() const {
  const live::RecordedAlarm& alarm = lasting.alarm;
  const bool hidden = alarm.synchronous != monitor::SynchronousChatter::none;
  Json out = {{"number", number},
              {"kind", row_kinds[static_cast<std::size_t>(kind)]},
              {"clock_s", io::number(clock_s)},
              {"from_s", io::number(alarm.from_s)},
              {"to_s", io::number(alarm.to_s)},
              {"reason", kind == Kind::blind ? Json(monitor::to_string(reason)) : Json(nullptr)},
              {"score", io::number(score)},
              {"low_frequency_hz", io::number(alarm.low_frequency_hz)},
              {"high_frequency_hz", io::number(alarm.high_frequency_hz)},
              {"chatter_frequency_hz", io::number(alarm.chatter_frequency_hz)},
              {"chatter_frequency_std_hz", io::number(alarm.chatter_frequency_std_hz)},
              {"channel", text_or_null(alarm.channel)},
              {"hidden", hidden ? Json(monitor::to_string(alarm.synchronous)) : Json(nullptr)},
              {"suggested_spindle_speed_rpm", io::positive(alarm.suggested_spindle_speed_rad_per_s, units::rpm)},
              {"line_frequencies_hz", alarm.line_hz},
              {"no_speed", text_or_null(name_in(monitor::no_speed_names, alarm.no_speed))},
              {"what", text_or_null(what)},
              {"count", alarm.count},
              {"message", text_or_null(message)},
              {"why", monitor::explanation_json(alarm.why)}};
  modal::set_mode(out, alarm.mode);
  return out;
}

MonitorHistory::Row& MonitorHistory::begin(Row row, double from_s) {
  row.number = ++last_;
  row.lasting.alarm.from_s = from_s;
  rows_.push_back(std::move(row));
  if (rows_.size() > most_rows) rows_.pop_front();
  return rows_.back();
}

MonitorHistory::Row* MonitorHistory::open_row() {
  if (rows_.empty() || open_ < rows_.front().number) return nullptr;  // it was dropped, or nothing lasts
  return &rows_[open_ - rows_.front().number];
}

void MonitorHistory::end(double time_s) {
  if (Row* const row = open_row()) {
    row->lasting.alarm.to_s = time_s;
    row->changed = true;
  }
  open_ = 0;
}

MonitorHistory::Row* MonitorHistory::lasting(monitor::State state, monitor::BlindReason reason, double time_s,
                                             double clock_s) {
  const bool chatters = state == monitor::State::chatter;
  const Row::Kind kind = chatters ? Row::Kind::chatter : Row::Kind::blind;
  if (Row* const row = open_row(); row && row->kind == kind && row->reason == reason) return row;
  end(time_s);
  if (!chatters && state != monitor::State::blind) return nullptr;
  Row& row = begin({.kind = kind, .clock_s = clock_s, .reason = reason}, time_s);
  open_ = row.number;
  return &row;
}

void MonitorHistory::note(Row& row, const monitor::Decision& decision) const {
  const bool worse = alarm_below_ ? decision.score < row.score : decision.score > row.score;
  if (worse || std::isnan(row.score)) row.score = decision.score;
  row.lasting.note(decision, channels_);
}

void MonitorHistory::add(const monitor::Decision& decision, double time_s, double clock_s) {
  const monitor::BlindReason reason =
      decision.state == monitor::State::blind ? decision.reason : monitor::BlindReason::none;
  Row* const row = lasting(decision.state, reason, time_s, clock_s);
  if (!row || row->kind != Row::Kind::chatter) return;
  note(*row, decision);
  row->changed = true;
}

void MonitorHistory::add(const monitor::MonitorEvent& event, const std::string& message, double clock_s) {
  using Kind = monitor::MonitorEvent::Kind;
  const monitor::Decision& decision = event.decision;
  if (event.kind == Kind::stream) {
    const bool again = !rows_.empty() && rows_.back().what == event.what;
    Row& row = again ? rows_.back() : begin({.clock_s = clock_s, .what = event.what}, event.time_s);
    row.lasting.alarm.to_s = event.time_s;
    row.message = message.substr(0, longest_message);
    row.lasting.alarm.count += event.count;
    row.changed = true;
    return;
  }
  // That no samples come is no decision.
  if (decision.state == monitor::State::blind) {
    static_cast<void>(lasting(monitor::State::blind, decision.reason, event.time_s, clock_s));
    return;
  }
  Row* const row = open_row();
  if (row && row->kind == Row::Kind::chatter && row->lasting.advise(event)) row->changed = true;
}

Json MonitorHistory::rows() const {
  Json out = Json::array();
  for (auto row = rows_.rbegin(); row != rows_.rend(); ++row) out.push_back(row->json());
  return out;
}

Json MonitorHistory::take_changed() {
  Json out = Json::array();
  for (auto row = rows_.rbegin(); row != rows_.rend() && out.size() < most_changed; ++row) {
    if (std::exchange(row->changed, false)) out.push_back(row->json());
  }
  return out;
}

}  // namespace robomill::serve
