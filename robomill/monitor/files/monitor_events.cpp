#include "robomill/monitor/files/monitor_events.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_schema.hpp"
#include "robomill/monitor/files/event_schema.hpp"
#include "robomill/monitor/files/explanation_schema.hpp"

namespace robomill::monitor {
namespace {

constexpr std::array<Fault, 6> all_faults = {not_finite,        stuck,        clipped, dead_channel,
                                             wrong_sample_rate, speed_unknown};

using io::add_rows;
using io::if_positive;
using io::key;
using io::of;
using io::Row;

/// A number of the last decision.
Row<MonitorEvent> of_decision(const std::string& name, double Decision::*member, const std::string& meaning) {
  return of(&MonitorEvent::decision, key(name, member, meaning).nullable());
}

/// The same of one that is > 0.
template <class F>
Row<MonitorEvent> positive(const std::string& name, F value, const std::string& meaning) {
  return key(
             name, [value](const MonitorEvent& event) { return if_positive(value(event)); }, meaning)
      .nullable();
}

bool chatters(const MonitorEvent& event) {
  return event.decision.chatter_frequency_hz > 0.0;
}

template <class Value>
std::optional<Value> if_chatters(const MonitorEvent& event, Value value) {
  return chatters(event) ? std::optional(value) : std::nullopt;
}

std::vector<Row<MonitorEvent>> chatter_keys() {
  using Event = MonitorEvent;
  std::vector<Row<Event>> rows = {
      positive(
          "chatter_frequency_hz", [](const Event& e) { return e.decision.chatter_frequency_hz; }, "none: no chatter"),
      key(
          "chatter_frequency_std_hz",
          [](const Event& e) { return if_chatters(e, e.decision.chatter_frequency_std_hz); }, "standard deviation")
          .nullable(),
      key(
          "channel", [](const Event& e) { return if_chatters(e, e.decision.channel + 1); },
          "in which it is strongest, from 1")
          .nullable(),
      hidden_key<Event>([](const Event& e) { return e.decision.synchronous; })};
  add_rows(rows, modal::mode_keys<Event>("that chatters"));
  rows.push_back(key("line_frequencies_hz", &Event::line_hz, "what a line that was measured folded may be"));
  return rows;
}

std::vector<Row<MonitorEvent>> advice_keys() {
  using Event = MonitorEvent;
  return {
      positive(
          "spindle_speed_rpm", [](const Event& e) { return e.decision.spindle_speed_rad_per_s; },
          "tracked; none: not known"),
      positive(
          "spindle_speed_std_rpm", [](const Event& e) { return e.decision.spindle_speed_std_rad_per_s; },
          "its standard deviation"),
      positive(
          "suggested_spindle_speed_rpm", [](const Event& e) { return e.suggested_spindle_speed_rad_per_s; },
          "that avoids chatter"),
      positive(
          "suggested_axial_depth_mm", [](const Event& e) { return e.suggested_axial_depth_m; }, "that avoids chatter"),
      key("depth_limited_by", &Event::depth_limited_by, depth_limited_by_names, "none: no depth is suggested")
          .nullable(),
      key("stable_spindle_speeds_rpm", &Event::stable_speeds_rad_per_s, "at which the present depth is stable"),
      key("no_speed", &Event::no_speed, no_speed_names, "why no speed is suggested").nullable(),
      key("command", &Event::command, "that followed by a rule of [act]")
          .words({"spindle-speed", "feed", "hold", "release", "none"})
          .nullable(),
      key(
          "faults", [](const Event& e) { return fault_names(e.decision.faults); }, "of the input")
          .words(words_of(all_faults)),
      key(
          "suggested_sample_rate_hz",
          [](const Event& e) {
            return (e.decision.faults & wrong_sample_rate) != 0 ? if_positive(e.decision.suggested_sample_rate_hz)
                                                                : std::nullopt;
          },
          "where the sample rate is wrong")
          .nullable(),
      key("compute_us", &Event::compute_s, "of the decision").nullable()};
}

std::vector<Row<MonitorEvent>> first_keys() {
  return {key("time_s", &MonitorEvent::time_s, "of the stream").nullable(),
          key("event", &MonitorEvent::kind, event_kind_names, "what changed")};
}

/// What events of one kind alone have.
std::vector<Row<MonitorEvent>> own_keys() {
  using Event = MonitorEvent;
  const auto is = [](Event::Kind kind) { return [kind](const Event& event) { return event.kind == kind; }; };
  return {
      where(is(Event::Kind::stream), key("what", &Event::what, "befell the samples").nullable()),
      where(is(Event::Kind::stream), key("count", &Event::count, "how often")),
      where(is(Event::Kind::recording), key("file", &Event::file, "that was written").nullable()),
      where([](const Event& event) { return !event.message.empty(); }, key("message", &Event::message, "for people"))};
}

Row<MonitorEvent> why_key() {
  using Event = MonitorEvent;
  const auto decides = [](const Event& event) {
    const bool of_decision = event.kind == Event::Kind::state || event.kind == Event::Kind::window;
    return event.explained && of_decision && known(event.decision.why) != nullptr;
  };
  return where(decides, key(
                            "why", [](const Event& event) { return known(event.decision.why); }, explanation_table(),
                            "with `--why`, of states and windows"));
}

/// Of names of files whatever their bytes.
std::string line_of(const io::Json& json) {
  return io::plain_text(json) + '\n';
}

}  // namespace

std::string_view to_string(MonitorEvent::Kind kind) {
  return name_in(event_kind_names, kind);
}

std::vector<std::string> fault_names(std::uint32_t faults) {
  std::vector<std::string> names;
  for (const Fault fault : all_faults) {
    if ((faults & fault) != 0) names.emplace_back(to_string(fault));
  }
  return names;
}

std::string line_text(const std::vector<double>& line_hz) {
  if (line_hz.empty()) return {};
  std::string out = fmt::format("{:.1f}", line_hz.front());
  for (std::size_t i = 1; i < line_hz.size(); ++i) {
    out += fmt::format("{}{:.1f}", i + 1 < line_hz.size() ? ", " : " or ", line_hz[i]);
  }
  return out + (line_hz.size() == 1 ? " Hz folded" : " Hz");
}

const io::Schema<MonitorEvent>& event_table() {
  using Event = MonitorEvent;
  static const io::Schema<Event> table(
      "monitor_event", "what the monitor reports",
      [] {
        std::vector<Row<Event>> rows = first_keys();
        add_rows(rows, state_keys<Event>(
                           [](const Event& event) { return std::pair(event.decision.state, event.decision.reason); }));
        add_rows(rows, {of_decision("score", &Decision::score, "of the detector"),
                        of_decision("threshold", &Decision::threshold, "of the score"),
                        of_decision("energy_entropy", &Decision::energy_entropy, "of the spectrum"),
                        of_decision("level", &Decision::level, "of the signal")});
        add_rows(rows, chatter_keys());
        add_rows(rows, advice_keys());
        add_rows(rows, own_keys());
        rows.push_back(why_key());
        return rows;
      }(),
      io::Use::written);
  return table;
}

std::string event_line(const MonitorEvent& event) {
  return line_of(event_table().write(event));
}

std::string started_line(const SessionStart& start) {
  using Start = SessionStart;
  static const io::Schema<Start> table(
      "started", "that a session began to append",
      {key(
           "time_s", [](const Start&) { return 0.0; }, "of the stream"),
       key(
           "event", [](const Start&) { return "started"; }, "what this line is")
           .words({"started"}),
       key("started", &Start::started, "in UTC"), key("input", &Start::input, "a file or an address"),
       key("config", &Start::config, "monitor.toml"), key("version", &Start::version, "of robomill"),
       where([](const Start& s) { return !s.message.empty(); }, key("message", &Start::message, "for people"))},
      io::Use::written);
  return line_of(table.write(start));
}

std::string lost_events_line(std::uint64_t count) {
  static const io::Schema<MonitorEvent> table(
      "events_lost", "that events could not be kept",
      [] {
        std::vector<Row<MonitorEvent>> rows = first_keys();
        add_rows(rows, own_keys());
        return rows;
      }(),
      io::Use::written);
  return line_of(table.write({.kind = MonitorEvent::Kind::stream,
                              .time_s = std::numeric_limits<double>::quiet_NaN(),
                              .what = "events-lost",
                              .count = count,
                              .message = "events that could not be written here were too many to keep"}));
}

}  // namespace robomill::monitor
