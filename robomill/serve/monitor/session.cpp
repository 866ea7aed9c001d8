#include "robomill/serve/monitor/session.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <exception>
#include <functional>
#include <new>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/monitor.hpp"
#include "robomill/live/inputs.hpp"
#include "robomill/monitor/files/explanation_schema.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/monitor/paced_source.hpp"

namespace robomill::serve {
namespace {

using io::Json;

constexpr std::array<const char*, 4> status_names = {"starting", "running", "done", "failed"};
constexpr std::chrono::milliseconds frame_pause(100);
constexpr double pace_over_s = 2.0;

/// Acts when it goes, whatever ends the block.
struct AtEnd {
  std::function<void()> act;
  ~AtEnd() { act(); }
};

Json counts_of(const live::MetricValues& metrics) {
  Json blind = Json::object();
  for (const monitor::BlindReason reason : monitor::blind_reasons) {
    const double blind_s = metrics.blind_for_s(reason);
    if (blind_s > 0.0) blind[std::string(monitor::to_string(reason))] = io::number(blind_s);
  }
  return {{"alarm_count", metrics.alarms.load()},
          {"decision_count", metrics.decisions.load()},
          {"dropped_hops", metrics.dropped_hops.load()},
          {"lost_blocks", metrics.lost_blocks.load()},
          {"blind_s", std::move(blind)}};
}

}  // namespace

MonitorSession::MonitorSession(Options options, MonitorInput input, Publish publish)
    : options_(std::move(options)),
      publish_(std::move(publish)),
      input_(std::move(input)),
      is_stream_(!input_.recording),
      spectrum_(input_.file.options),
      counts_(counts_of(live::MetricValues())),
      frames_(input_.file.options.alarm_below),
      history_(input_.file.columns.channels, input_.file.options.alarm_below) {
  if (is_stream_ && !options_.open_stream) {
    throw InvalidInput("input", input_.name + " is a stream, and this server takes none",
                       "Give a recording of the folder");
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

MonitorSession::~MonitorSession() {
  stop();
}

void MonitorSession::stop() {
  {
    const std::lock_guard lock(publishing_);
    stop_ = true;
  }
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  if (session_ != nullptr) session_->queue().close();
}

void MonitorSession::send(std::string_view event, const std::string& data) {
  const std::lock_guard lock(publishing_);
  if (stop_) return;
  try {
    publish_(event, data);
  } catch (const std::exception&) {
    // No memory for a message, say: the next one tells how it stands.
  }
}

bool MonitorSession::over() const {
  const std::lock_guard lock(mutex_);
  return status_ == Status::done || status_ == Status::failed;
}

double MonitorSession::clock_s() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

void MonitorSession::run(const std::stop_token& stop) {
  Status status = Status::done;
  Json error = nullptr;
  try {
    receive(stop);
  } catch (const Interrupted&) {
    // It was asked to end.
  } catch (const InvalidInput& found) {
    status = Status::failed;
    error = error_object(found, options_.root);
  } catch (const std::bad_alloc&) {
    status = Status::failed;
    error = error_object("not enough memory for this input");
  } catch (const std::exception& found) {
    status = Status::failed;
    error = error_object(client_text(found.what(), options_.root));
  }
  set_status(status, std::move(error));
}

void MonitorSession::receive(const std::stop_token& stop) {
  const monitor::MonitorFile& file = input_.file;
  Progress progress({}, &stop_);
  live::AdviceBasis basis = jobs::read_advice_basis(file, progress);
  {
    const std::lock_guard lock(mutex_);
    teeth_ = basis.teeth;
    assumed_ = basis.assumed;
    warnings_ = basis.warnings;
    for (std::string& warning : warnings_) warning = client_text(warning, options_.root);
  }
  const live::Advisor advisor(std::move(basis));
  live::Session session(file, {.live = is_stream_}, outputs(advisor));
  show(&session);
  const AtEnd hide{[this] { show(nullptr); }};
  std::shared_ptr<void> connection;
  std::optional<live::SourceInput> reader;
  if (is_stream_) {
    connection = options_.open_stream(file, {session.queue(), session.notices(), session.metrics()}, stop_);
  } else {
    std::unique_ptr<io::SampleSource> source = std::move(input_.recording);
    if (options_.speed > 0.0) {
      source = std::make_unique<PacedSource>(std::move(source), static_cast<std::size_t>(file.options.channels),
                                             options_.speed * file.options.sample_rate_hz, stop);
    }
    reader.emplace(std::move(source), file, session.queue(), session.notices(), session.metrics(), true);
  }
  set_status(Status::running);
  {
    const AtEnd end{[&session] { session.queue().close(); }};  // lets the input go before it is waited for
    session.run(stop_);
  }
  {
    const std::lock_guard lock(mutex_);
    history_.end(session.time_s());
  }
  publish_due(true);
  publish_rest();
}

void MonitorSession::show(live::Session* session) {
  const std::lock_guard lock(mutex_);
  if (session_ != nullptr) counts_ = counts_of(session_->metrics());
  session_ = session;
}

live::SessionOutputs MonitorSession::outputs(const live::Advisor& advisor) {
  live::SessionOutputs out;
  out.advise = [&advisor](monitor::MonitorEvent& event) { advisor.advise(event); };
  out.decision = [this](const monitor::Decision& decision, double time_s, double compute_s) {
    decide(decision, time_s, compute_s);
  };
  out.event = [this](const monitor::MonitorEvent& event, const std::string&) {
    take(event);
    return true;
  };
  out.samples = [this](std::span<const float> samples) {
    spectrum_.add(samples);
    publish_due();
  };
  out.skipped = [this](std::uint64_t, monitor::BlindReason) { spectrum_.restart(); };
  out.idle = [this] { publish_due(); };
  out.overloaded = [this](const monitor::MonitorEvent& event, const std::string&) { take_overload(event); };
  return out;
}

void MonitorSession::put(const MonitorFrame& frame) {
  if (pending_) {
    join(*pending_, frame, input_.file.options.alarm_below);
  } else {
    pending_ = frame;
  }
}

void MonitorSession::decide(const monitor::Decision& decision, double time_s, double compute_s) {
  if (decision.state != monitor::State::chatter) advised_ = {};
  MonitorFrame frame = advised_;
  frame.time_s = time_s;
  frame.state = decision.state;
  frame.reason = decision.reason;
  if (decision.state != monitor::State::blind) frame.score = decision.score;
  frame.threshold = decision.threshold;
  frame.spindle_speed_rad_per_s = decision.spindle_speed_rad_per_s;
  frame.chatter_frequency_hz = decision.chatter_frequency_hz;
  frame.chatter_frequency_std_hz = decision.chatter_frequency_std_hz;
  frame.why = decision.why;
  frame.faults = decision.faults;
  frame.compute_s = compute_s;
  put(frame);
  const std::lock_guard lock(mutex_);
  history_.add(decision, time_s, clock_s());
}

void MonitorSession::take(const monitor::MonitorEvent& event) {
  const monitor::Decision& decision = event.decision;
  if (decision.state == monitor::State::chatter) {
    advised_.mode = event.mode;
    advised_.suggested_spindle_speed_rad_per_s = event.suggested_spindle_speed_rad_per_s;
    advised_.no_speed = event.no_speed;
    if (pending_ && pending_->state == monitor::State::chatter) {
      pending_->mode = advised_.mode;
      pending_->suggested_spindle_speed_rad_per_s = advised_.suggested_spindle_speed_rad_per_s;
      pending_->no_speed = advised_.no_speed;
    }
  } else if (decision.state == monitor::State::blind) {  // perhaps without a decision: no samples come
    MonitorFrame frame;
    frame.time_s = event.time_s;
    frame.state = monitor::State::blind;
    frame.reason = decision.reason;
    put(frame);
  }
  const std::string message = client_text(event.message, options_.root);
  const std::lock_guard lock(mutex_);
  history_.add(event, message, clock_s());
}

/// Of another thread: the session's hangs.
void MonitorSession::take_overload(const monitor::MonitorEvent& event) {
  try {
    MonitorFrame frame;
    frame.clock_s = clock_s();
    frame.time_s = event.time_s;
    frame.state = event.decision.state;
    frame.reason = event.decision.reason;
    Json message = {{"id", options_.id}, {"frame", frame_json(frame)}, {"why", nullptr}};
    {
      const std::lock_guard lock(mutex_);
      frames_.add(frame);
      history_.add(event, {}, frame.clock_s);
      message["alarms"] = history_.take_changed();
      message.update(counts());
    }
    send("monitor", io::plain_text(message));
  } catch (const std::exception&) {
    // No memory for a message, say: the state is in what the next one tells.
  }
}

/// Of the last seconds: seconds of the stream a second of the clock.
double MonitorSession::pace(const MonitorFrame& frame) {
  const double went_by_s = frame.clock_s - pace_clock_s_;
  if (went_by_s >= pace_over_s) {
    pace_ = (frame.time_s - pace_time_s_) / went_by_s;
    pace_clock_s_ = frame.clock_s;
    pace_time_s_ = frame.time_s;
  }
  return pace_;
}

void MonitorSession::publish_due(bool last) {
  const Clock::time_point now = Clock::now();
  if (!pending_ || (!last && now - published_ < frame_pause)) return;
  published_ = now;
  MonitorFrame frame = *std::exchange(pending_, std::nullopt);
  frame.clock_s = clock_s();
  frame.pace = pace(frame);
  frame.amplitude = spectrum_.take();
  Json message = {{"id", options_.id}, {"frame", frame_json(frame)}, {"why", monitor::explanation_json(frame.why)}};
  {
    const std::lock_guard lock(mutex_);
    frames_.add(frame);
    message["alarms"] = history_.take_changed();
    message.update(counts());
  }
  send("monitor", io::plain_text(message));
}

/// Rows that changed with the stream's end, or were more than the last message took.
void MonitorSession::publish_rest() {
  for (;;) {
    Json message;
    {
      const std::lock_guard lock(mutex_);
      Json changed = history_.take_changed();
      if (changed.empty() || frames_.frames().empty()) return;
      MonitorFrame frame = frames_.frames().back();
      frame.amplitude.clear();
      message = {{"id", options_.id},
                 {"frame", frame_json(frame)},
                 {"why", monitor::explanation_json(frame.why)},
                 {"alarms", std::move(changed)}};
      message.update(counts());
    }
    send("monitor", io::plain_text(message));
  }
}

void MonitorSession::set_status(Status status, Json error) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
    error_ = std::move(error);
    if (status == Status::done || status == Status::failed) ended_s_ = clock_s();
  }
  send("monitors", "{}");
}

/// The mutex is held.
Json MonitorSession::counts() const {
  return session_ != nullptr ? counts_of(session_->metrics()) : counts_;
}

Json MonitorSession::summary() const {
  const std::lock_guard lock(mutex_);
  const monitor::MonitorOptions& options = input_.file.options;
  Json out = {
      {"id", options_.id},
      {"config", options_.config},
      {"input", input_.name},
      {"speed", is_stream_ ? Json(nullptr) : io::number(options_.speed)},
      {"status", status_names[static_cast<std::size_t>(status_)]},
      {"error", error_},
      {"started", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(started_)))},
      {"clock_s", io::number(std::isnan(ended_s_) ? clock_s() : ended_s_)},
      {"channels", input_.file.columns.channels},
      {"sample_rate_hz", io::number(options.sample_rate_hz)},
      {"teeth", teeth_ > 0 ? Json(teeth_) : Json(nullptr)},
      {"frame", nullptr},
      {"why", nullptr}};
  out.update(counts());
  if (!frames_.frames().empty()) {
    MonitorFrame frame = frames_.frames().back();
    frame.amplitude.clear();
    out["frame"] = frame_json(frame);
    out["why"] = monitor::explanation_json(frame.why);
  }
  return out;
}

Json MonitorSession::all() const {
  Json out = summary();
  out["edges_hz"] = Json::array();
  for (const double edge : spectrum_.edges_hz()) out["edges_hz"].push_back(io::number(edge));
  std::deque<MonitorFrame> frames;
  {
    const std::lock_guard lock(mutex_);
    out["assumed"] = io::assumed_json(assumed_);
    out["warnings"] = warnings_;
    out["alarms"] = history_.rows();
    frames = frames_.frames();
  }
  out["frames"] = Json::array();
  for (const MonitorFrame& frame : frames) out["frames"].push_back(frame_json(frame));
  return out;
}

}  // namespace robomill::serve
