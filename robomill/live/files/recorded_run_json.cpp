#include "robomill/live/files/recorded_run_json.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "robomill/modal/files/mode_schema.hpp"
#include "robomill/monitor/files/event_schema.hpp"
#include "robomill/monitor/files/explanation_schema.hpp"
#include "robomill/signal/files/bands_json.hpp"

namespace robomill::live {
namespace {

using io::add_rows;
using io::if_positive;
using io::Json;
using io::key;
using io::Row;
using io::Schema;
using io::Use;
using signal::band_key;

struct Fact {
  std::string label = {}, value = {};
};

const Schema<Fact>& fact_table() {
  static const Schema<Fact> table("recorded_fact", "what was recorded",
                                  {key("label", &Fact::label, "of what"), key("value", &Fact::value, "in words")},
                                  Use::written);
  return table;
}

const Schema<RecordedChannel>& channel_table() {
  static const Schema<RecordedChannel> table("recorded_channel", "the samples of one channel over time",
                                             {key("name", &RecordedChannel::name, "as in its file"),
                                              band_key("wave", &RecordedChannel::wave, "of the samples")},
                                             Use::written);
  return table;
}

/// Whole decibels: finer ones no colour shows. A row a frequency.
std::vector<std::vector<std::optional<int>>> levels(const Spectrogram& spectrogram) {
  std::vector<std::vector<std::optional<int>>> rows;
  for (Eigen::Index i = 0; i < spectrogram.level_db.rows(); ++i) {
    std::vector<std::optional<int>>& row = rows.emplace_back();
    for (const double level : spectrogram.level_db.row(i))
      row.push_back(std::isnan(level) ? std::nullopt : std::optional(static_cast<int>(std::lround(level))));
  }
  return rows;
}

const Schema<Spectrogram>& spectrogram_table() {
  static const Schema<Spectrogram> table(
      "spectrogram", "synchrosqueezed spectrum over time, a row a frequency",
      {key("channel", &Spectrogram::channel, "that was loudest in chatter, or the first"),
       key("begin_s", &Spectrogram::begin_s, "of the first column"),
       key("step_s", &Spectrogram::step_s, "of the columns"),
       key("max_frequency_hz", &Spectrogram::max_frequency_hz, "highest worth drawing"),
       key("frequency_hz", &Spectrogram::frequency_hz, "of the rows").exact(),
       key(
           "level_db", [](const Spectrogram& spectrogram) { return levels(spectrogram); },
           "below the strongest of all; none: a gap")
           .nullable()},
      Use::written);
  return table;
}

const Schema<RecordedRun>& decisions_table() {
  using Run = RecordedRun;
  static const Schema<Run> table(
      "recorded_decisions", "numbers of the decisions, over equal runs of time",
      {key("run_s", &Run::decision_run_s, "of one run"), band_key("score", &Run::score, "of the detector"),
       band_key("threshold", &Run::threshold, "of the score"),
       band_key("energy_entropy", &Run::energy_entropy, "of the spectrum"),
       band_key("chatter_frequency_hz", &Run::chatter_frequency_hz, "while in chatter"),
       band_key("spindle_speed_rpm", &Run::spindle_speed_rad_per_s, "tracked"),
       band_key("spindle_speed_std_rpm", &Run::spindle_speed_std_rad_per_s, "its standard deviation")},
      Use::written);
  return table;
}

/// A state with its reason, and times.
template <class T>
std::vector<Row<T>> timed(std::vector<Row<T>> times) {
  std::vector<Row<T>> rows =
      monitor::state_keys<T>([](const T& object) { return std::pair(object.state, object.reason); });
  add_rows(rows, std::move(times));
  return rows;
}

const Schema<Stay>& stay_table() {
  static const Schema<Stay> table(
      "stay", "a stay in one state",
      timed<Stay>({key("from_s", &Stay::from_s, "its begin"), key("to_s", &Stay::to_s, "its end")}), Use::written);
  return table;
}

const Schema<StateTime>& state_time_table() {
  static const Schema<StateTime> table(
      "state_time", "how long the run was in a state",
      timed<StateTime>({key("duration_s", &StateTime::duration_s,
                            "of no-signal with the time by the clock in which no samples came")}),
      Use::written);
  return table;
}

const Schema<RecordedAlarm>& alarm_table() {
  using Alarm = RecordedAlarm;
  static const Schema<Alarm> table(
      "recorded_alarm", "alarms of about one frequency that follow each other",
      [] {
        std::vector<Row<Alarm>> rows = {
            key("count", &Alarm::count, "alarms"),
            key("from_s", &Alarm::from_s, "first begin"),
            key("to_s", &Alarm::to_s, "last end"),
            key("chatter_s", &Alarm::chatter_s, "in chatter between them"),
            key("low_frequency_hz", &Alarm::low_frequency_hz, "lowest decided").nullable(),
            key("high_frequency_hz", &Alarm::high_frequency_hz, "highest decided").nullable(),
            key("chatter_frequency_hz", &Alarm::chatter_frequency_hz, "the surest of them").nullable(),
            key("chatter_frequency_std_hz", &Alarm::chatter_frequency_std_hz, "its standard deviation").nullable(),
            key("channel", &Alarm::channel, "in which it was strongest then").nullable(),
            monitor::hidden_key<Alarm>([](const Alarm& alarm) { return alarm.synchronous; }),
            key(
                "suggested_spindle_speed_rpm",
                [](const Alarm& alarm) { return if_positive(alarm.suggested_spindle_speed_rad_per_s); },
                "that avoids chatter")
                .nullable(),
            key("line_frequencies_hz", &Alarm::line_hz, "what a line that was measured folded may be").exact(),
            key("no_speed", &Alarm::no_speed, monitor::no_speed_names, "why no speed is suggested").nullable()};
        add_rows(rows, modal::mode_keys<Alarm>("that chatters"));
        rows.push_back(key(
                           "why", [](const Alarm& alarm) { return monitor::known(alarm.why); },
                           monitor::explanation_table(), "the first one began; none: the detector does not say")
                           .nullable());
        return rows;
      }(),
      Use::written);
  return table;
}

/// Lines of events, written before.
Row<RecordedRun> event_key() {
  Row<RecordedRun> row = key(
      "events", [](const RecordedRun&) { return std::vector<monitor::MonitorEvent>(); }, monitor::event_table(),
      "as in events.jsonl, 400 at most");
  row.write = [](const RecordedRun& run, const Row<RecordedRun>&) {
    Json events = Json::array();
    for (const std::string& event : run.events) {
      events.push_back(io::parsed_or_discarded(event));
      if (events.back().is_discarded()) throw InvalidInput("events", "must be lines of JSON");
    }
    return events;
  };
  return row;
}

}  // namespace

const Schema<RecordedRun>& recorded_run_table() {
  using Run = RecordedRun;
  static const Schema<Run> table(
      "monitor", "a recording as the chatter monitor processed it",
      {key(
           "facts",
           [](const Run& run) {
             std::vector<Fact> out;
             for (const auto& [label, value] : run.facts) out.push_back({label, value});
             return out;
           },
           fact_table(), "in words"),
       key("warnings", &Run::warnings, "sentences for the user"), key("notes", &Run::notes, "sentences for the user"),
       key("unit", &Run::unit, "of the samples, where the names of all channels end in one"),
       key("wave_run_s", &Run::wave_run_s, "of one run of the samples"),
       key("channels", &Run::channels, channel_table(), "over equal runs of time"),
       key(
           "spectrogram",
           [](const Run& run) { return run.spectrogram.level_db.size() == 0 ? nullptr : &run.spectrogram; },
           spectrogram_table(), "none: no signal")
           .nullable(),
       key(
           "decisions", [](const Run& run) { return &run; }, decisions_table(), "over equal runs of time"),
       key("decision_count", &Run::decisions, "decisions"),
       key("compute_mean_us", &Run::compute_mean_s, "of one decision").nullable(),
       key("compute_max_us", &Run::compute_max_s, "of one decision").nullable(),
       key(
           "teeth", [](const Run& run) { return run.teeth > 0 ? std::optional(run.teeth) : std::nullopt; },
           "of the cutter; none: not known")
           .nullable(),
       key("stays", &Run::stays, stay_table(), "one after the other, 2,000 at most"),
       key("state_times", &Run::state_times, state_time_table(), "all stays together, also those that are not listed"),
       key("alarm_count", &Run::alarm_count, "alarms"),
       key("alarms", &Run::alarms, alarm_table(), "consecutive ones of one frequency in one row, 100 at most"),
       event_key()},
      Use::written, 1);
  return table;
}

std::string recorded_run_json(const RecordedRun& run) {
  return io::dump(recorded_run_table().write(run));
}

}  // namespace robomill::live
