#include "robomill/monitor/monitor.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "monitor/broker.hpp"
#include "monitor/event_file.hpp"
#include "monitor/metrics_server.hpp"
#include "monitor/report.hpp"
#include "monitor/watch.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/monitor.hpp"
#include "robomill/live/inputs.hpp"
#include "robomill/live/recorder.hpp"
#include "robomill/live/session.hpp"
#include "robomill/monitor/explanation.hpp"
#include "robomill/monitor/files/machine_json.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// What events and report may take after Ctrl-C.
constexpr double saving_s = 10.0;

using io::RawFormat;
using monitor::MonitorEvent;

constexpr Name<RawFormat> raw_formats[] = {
    {"auto", RawFormat::automatic}, {"f32", RawFormat::float32}, {"i16", RawFormat::int16}, {"csv", RawFormat::csv}};

/// The monitor's input.
struct Input {
  bool is_stream = false;  ///< from the broker
  bool by_clock = false;   ///< its samples come while they are taken: where none come, something is wrong
  bool can_wait = true;
  std::string name;
  std::unique_ptr<io::SampleSource> source;
};

/// Pipes, sockets and devices have their samples when they are taken; a file, on standard input too, has them all.
bool is_file(int descriptor) {
  struct stat status = {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Samples of several files, whose channels are apart. Formats that are read block by block are not joined: a recording
/// of any length takes the same memory.
void open_files(const jobs::VerbJob& job, const monitor::MonitorFile& file, Input& input) {
  std::vector<std::filesystem::path> files;
  for (const std::string& place : job.texts("input")) {
    monitor::MqttSettings unused;
    if (place == "-" || monitor::parse_mqtt_address(place, unused)) {
      throw InvalidInput("--input", place + " is a stream, and stands beside others", "Files alone are joined");
    }
    if (job.has("format")) throw InvalidInput("--format", "is of one input, and --input names several");
    if (io::is_read_as_record(place) && std::filesystem::exists(place) && !io::is_held_whole(place)) {
      throw InvalidInput(place, "is read block by block, and joined with another file it would have to be held whole",
                         "Write all channels into one WAV or one table, or into files of .mat, .h5, .npz or .tdms");
    }
    files.emplace_back(place);
    input.name += (input.name.empty() ? "" : " + ") + place;
  }
  input.source = io::open_samples(files, file.columns);
}

Input open_input(const jobs::VerbJob& job, monitor::MonitorFile& file, const std::atomic<bool>& ended) {
  Input input;
  const std::vector<std::string> places = job.texts("input");
  const std::string place = places.empty() ? std::string() : places.front();
  const bool several = places.size() > 1;
  input.is_stream =
      place.empty() ? !file.mqtt.topic.empty() : !several && monitor::parse_mqtt_address(place, file.mqtt);
  if (input.is_stream) {
    input.by_clock = true;
    input.name = fmt::format("mqtt://{}:{}/{}", file.mqtt.host, file.mqtt.port_or_default(), file.mqtt.topic);
    if (file.options.sample_rate_hz <= 0.0) {
      throw InvalidInput(InvalidInput::Parts{
          .where = file.path.string(), .field = "signal.sample_rate_hz", .rule = "must be given for a stream"});
    }
    return input;
  }
  if (place.empty()) {
    throw InvalidInput("--input", "is missing, and monitor.toml names no mqtt.topic",
                       "Give a recording, - for standard input, or mqtt://HOST/TOPIC");
  }
  const RawFormat format = job.word("format", raw_formats).value_or(RawFormat::automatic);
  if (several) {
    open_files(job, file, input);
  } else if (place == "-") {
    input.name = "standard input";
    input.by_clock = !is_file(STDIN_FILENO);
    input.can_wait = !job.flag("live");
    input.source = io::open_sample_stream(STDIN_FILENO, input.name, file.columns, format, &ended);
  } else {
    input.name = place;
    input.by_clock = std::filesystem::is_fifo(place);
    input.source = io::open_samples(place, file.columns, format, &ended);
  }
  if (file.options.sample_rate_hz <= 0.0) file.options.sample_rate_hz = input.source->sample_rate_hz();
  if (file.options.full_scale <= 0.0) file.options.full_scale = input.source->full_scale();
  return input;
}

void print_alias(std::FILE* to, const MonitorEvent& event) {
  const std::string line = monitor::line_text(event.line_hz);
  if (event.no_speed != monitor::NoSpeed::ambiguous_alias) {
    if (!line.empty()) fmt::print(to, " ({})", line);
  } else if (event.message.empty()) {
    fmt::print(to, "; no mode, no speed: signal.anti_alias_filter is not stated, the line may be {}", line);
  }
}

void print_why(std::FILE* to, const monitor::Decision& decision) {
  const std::string why = monitor::why_text(decision.why, decision.state);
  if (!why.empty()) fmt::print(to, "{:14}{}\n", "", why);
}

void print_event(std::FILE* to, const MonitorEvent& event) {
  const monitor::Decision& d = event.decision;
  if (event.kind == MonitorEvent::Kind::window) return;
  fmt::print(to, "{:10.3f} s  ", event.time_s);
  switch (event.kind) {
    case MonitorEvent::Kind::state:
      fmt::print(to, "{}", monitor::to_string(d.state));
      if (d.state == monitor::State::blind) fmt::print(to, " ({})", monitor::to_string(d.reason));
      if (d.state == monitor::State::chatter && d.chatter_frequency_hz > 0.0) {
        fmt::print(to, " at {:.1f} ± {:.2g} Hz", d.chatter_frequency_hz, d.chatter_frequency_std_hz);
        if (d.synchronous != monitor::SynchronousChatter::none)
          fmt::print(to, " ({})", monitor::to_string(d.synchronous));
        print_alias(to, event);
        if (event.mode.known()) fmt::print(to, ", {}", to_string(event.mode));
        if (event.suggested_spindle_speed_rad_per_s > 0.0) {
          fmt::print(to, "; try {:.0f} rpm", event.suggested_spindle_speed_rad_per_s / units::rpm);
        }
        if (event.suggested_axial_depth_m > 0.0) {
          fmt::print(to, " and {:.3g} mm", event.suggested_axial_depth_m / units::mm);
          if (event.depth_limited_by == monitor::DepthLimitedBy::forced_vibration) {
            fmt::print(to, " (limited by forced vibration)");
          }
        }
      }
      if (!event.message.empty()) fmt::print(to, "; {}", event.message);
      break;
    case MonitorEvent::Kind::fault: {
      std::string names;
      for (const std::string& name : monitor::fault_names(d.faults)) names += (names.empty() ? "" : ", ") + name;
      fmt::print(to, "input: {}", names.empty() ? "all well" : names);
      if ((d.faults & monitor::wrong_sample_rate) != 0 && d.suggested_sample_rate_hz > 0.0) {
        fmt::print(to, " (the comb suggests {:.6g} Hz)", d.suggested_sample_rate_hz);
      }
      break;
    }
    case MonitorEvent::Kind::recording:
      fmt::print(to, "recorded {}", printable(event.file));
      break;
    default:
      fmt::print(to, "{}{}: {}", event.what, event.count > 1 ? fmt::format(" ({})", event.count) : "",
                 printable(event.message));
  }
  fmt::print(to, "\n");
  if (event.explained && event.kind == MonitorEvent::Kind::state) print_why(to, d);
  std::fflush(to);
}

/// Lets go whoever waits for the queue or for input, before it is waited for.
class Ending {
 public:
  Ending(live::HopQueue& queue, std::atomic<bool>& ended) : queue_(&queue), ended_(&ended) {}
  ~Ending() {
    *ended_ = true;
    queue_->close();
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;

 private:
  live::HopQueue* queue_;
  std::atomic<bool>* ended_;
};

/// The file with what the command line says in its place.
monitor::MonitorFile read_config(const jobs::VerbJob& job) {
  monitor::MonitorFile file = monitor::read_monitor(job.input());
  if (job.has("record")) file.recording_folder = job.file("record");
  file.metrics_port = job.get("metrics_port", file.metrics_port);
  return file;
}

std::string summary_of(live::Session& session, const std::string& input) {
  const live::MetricValues& m = session.metrics();
  return fmt::format("{:.3f} s of {} processed in {} decisions, {} alarm{}.\n", session.time_s(), printable(input),
                     m.decisions.load(), m.alarms.load(), m.alarms.load() == 1 ? "" : "s");
}

/// No alarm says nothing of the time that could not be judged: that stands beside it.
std::string blind_summary(const live::MetricValues& m) {
  std::string out;
  for (const monitor::BlindReason reason : monitor::blind_reasons) {
    const double blind_s = m.blind_for_s(reason);
    if (blind_s > 0.0) out += fmt::format("cannot tell: {}, for {:.3g} s\n", monitor::to_string(reason), blind_s);
  }
  return out;
}

/// Where what a session finds goes: lines of events, what the terminal shows, the broker, the report.
class Outlets {
 public:
  Outlets(const jobs::VerbJob& job, const Common& common, const monitor::MonitorFile& file, const Input& input)
      : common_(&common),
        events_({.place = common.output,
                 .is_stream = input.by_clock,
                 .input = input.name,
                 .config = job.input().string()}) {
    if (!common.report.empty()) {
      const std::vector<std::string>& channels = file.columns.channels;
      recorder_.emplace(file.options, channels, unit_of(channels, file.options.tachometer_channel));
    }
    if (job.flag("watch")) watch_.emplace();
  }
  Outlets(const Outlets&) = delete;
  Outlets& operator=(const Outlets&) = delete;

  /// Calls back into this.
  live::SessionOutputs outputs(const live::Advisor& advisor, bool commands) {
    live::SessionOutputs out;
    out.event = [this](const MonitorEvent& event, const std::string& line) { return take(event, line); };
    out.decision = [this](const monitor::Decision& decision, double time_s, double compute_s) {
      take(decision, time_s, compute_s);
    };
    out.advise = [&advisor](MonitorEvent& event) { advisor.advise(event); };
    out.idle = [this] { events_.retry(); };
    out.overloaded = [this](const MonitorEvent& event, const std::string& line) { take_beside(event, line); };
    if (commands) {
      out.command = [this](const live::Command& issued) {
        if (broker_) broker_->publish(issued);
      };
    }
    if (recorder_) {
      out.samples = [this](std::span<const float> samples) { recorder_->add(samples); };
      out.skipped = [this](std::uint64_t frames, monitor::BlindReason why) { recorder_->skip(frames, why); };
      out.silent = [this](double seconds) { recorder_->silent(seconds); };
    }
    return out;
  }

  void report_to(live::Session& session) { events_.report_to(session.notices(), session.metrics()); }
  void send_by(Broker& broker) { broker_ = &broker; }
  /// All that the session needs is there.
  void begin() { events_.begin(); }
  /// @throws InvalidInput if an event could not be written
  void close() {
    watch_.reset();
    events_.close();
  }
  /// What else there is to say has been said. @throws InvalidInput if events of a stream still wait
  void require_saved() { events_.require_saved(); }
  /// Null without a report.
  live::Recorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }

 private:
  bool take(const MonitorEvent& event, const std::string& line) {
    if (recorder_ && event.kind != MonitorEvent::Kind::window) recorder_->add(event);
    if (broker_) broker_->publish(event, line);
    if (event.kind == MonitorEvent::Kind::state) say_load(event.decision);
    const bool news = common_->wants_summary() || (!common_->quiet && event.kind == MonitorEvent::Kind::stream);
    if (news && !watch_) print_event(common_->wants_summary() ? stdout : stderr, event);
    // That no samples come is no decision.
    if (watch_ && event.decision.state == monitor::State::blind) watch_->show(event.decision, event.time_s);
    return events_.write(line, event.kind == MonitorEvent::Kind::window);
  }
  /// Of another thread, while the session's hangs: perhaps in front of a terminal that was stopped, which comes last.
  void take_beside(const MonitorEvent& event, const std::string& line) {
    if (broker_) broker_->publish(event, line);
    events_.write_beside(line);
    say_load(event.decision);
  }
  /// To standard error, whatever else is shown there: a monitor that is late must not look quiet.
  void say_load(const monitor::Decision& decision) {
    if (decision.state == monitor::State::chatter) return;  // an alarm, late or not
    const bool overloaded =
        decision.state == monitor::State::blind && decision.reason == monitor::BlindReason::overloaded;
    if (overloaded_.exchange(overloaded) == overloaded) return;
    std::fputs(overloaded ? "robomill: decisions are more than a second behind the samples, or samples were left out: "
                            "blind (overloaded)\n"
                          : "robomill: decisions keep up with the samples again\n",
               stderr);
  }
  void take(const monitor::Decision& decision, double time_s, double compute_s) {
    events_.retry();
    if (recorder_) {
      monitor::Decision placed = decision;
      placed.time_s = time_s;
      recorder_->add(placed, compute_s);
    }
    if (watch_) watch_->show(decision, time_s);
  }

  const Common* common_;
  EventFile events_;
  std::optional<live::Recorder> recorder_;
  std::optional<Watch> watch_;
  Broker* broker_ = nullptr;
  std::atomic<bool> overloaded_{false};  ///< as it was said last
};

/// The broker that the file or the command line names, once it answers; a recording waits for it a little.
void connect(const Input& input, const monitor::MonitorFile& file, live::Session& session,
             const std::atomic<bool>& stop, Outlets& outlets, std::optional<Broker>& broker) {
  if (!input.is_stream && file.mqtt.events_topic.empty() && file.mqtt.commands_topic.empty()) return;
  broker.emplace(file, input.is_stream, session.queue(), session.notices(), session.metrics());
  outlets.send_by(*broker);
  if (input.is_stream) {
    broker->require_connection(stop, [&session] { session.emit_notices(); });
  } else {
    broker->wait_a_little();
  }
}

}  // namespace

Exit run_monitor(const jobs::VerbJob& job, const Common& common, Progress& progress) {
  monitor::MonitorFile file = read_config(job);
  std::atomic<bool> ended{false};
  Input input = open_input(job, file, ended);
  monitor::load_machine(file);
  monitor::validate(file);
  const live::AdviceBasis basis = jobs::read_advice_basis(file, progress);
  if (!common.quiet) {
    for (const std::string& note : basis.notes) fmt::print(stderr, "{}\n", printable(note));
  }
  for (const std::string& warning : basis.warnings) {
    fmt::print(stderr, "{}{}\n", io::warning_label, printable(warning));
  }
  const live::Advisor advisor(basis);
  Outlets outlets(job, common, file, input);
  live::Session session(file,
                        {.every_window = job.flag("every_window"),
                         .why = job.flag("why"),
                         .seconds = job.get("seconds", 0.0),
                         .live = input.by_clock},
                        outlets.outputs(advisor, !file.mqtt.commands_topic.empty()));
  outlets.report_to(session);
  std::optional<MetricsServer> metrics;
  if (file.metrics_port >= 0) {
    metrics.emplace(session.metrics(), file.metrics_host, file.metrics_port);
    if (!common.quiet) fmt::print(stderr, "metrics at http://{}:{}/metrics\n", file.metrics_host, metrics->port());
  }
  const std::atomic<bool>& stop = stop_on_signal();
  {
    std::optional<Broker> broker;
    connect(input, file, session, stop, outlets, broker);
    outlets.begin();
    std::optional<live::SourceInput> reader;
    if (input.source) {
      reader.emplace(std::move(input.source), file, session.queue(), session.notices(), session.metrics(),
                     input.can_wait);
    }
    const Ending ending(session.queue(), ended);
    session.run(stop);
    take_time_to_end(saving_s);
  }
  outlets.close();
  const std::string summary = summary_of(session, input.name);
  if (live::Recorder* const recorder = outlets.recorder()) {
    const live::RecordedRun recorded = recorder->run();
    page::Report page = monitor_page(recorded, file, input.name);
    page.assumed = basis.assumed;
    page.warnings = basis.warnings;
    page.summary = summary + run_summary(recorded) + assumed_text(basis.assumed);
    write_report(common.report, page);
  }
  if (common.wants_summary()) {
    fmt::print("{}{}{}", summary, blind_summary(session.metrics()), assumed_text(basis.assumed));
  }
  outlets.require_saved();
  return stop ? static_cast<Exit>(exit_of_signal()) : done;
}

}  // namespace robomill::app
