#include "event_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/monitor/files/monitor_events.hpp"
#include "robomill/version.hpp"

namespace robomill::app {
namespace {

constexpr std::chrono::seconds retry_pause{1};

/// To standard error, which may be closed.
void say(const std::string& text) {
  std::fputs(("robomill: " + printable(text) + "\n").c_str(), stderr);
}

}  // namespace

EventFile::EventFile(const Options& options) : to_stdout_(options.place == "-") {
  if (to_stdout_ || options.place.empty()) return;
  if (options.is_stream) {
    log_.emplace(options.place, io::AppendLog::Options{.lost_line = monitor::lost_events_line});
    begin(options);
  } else {
    whole_.emplace(options.place);
  }
}

void EventFile::begin(const Options& options) {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  monitor::SessionStart start{.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)),
                              .input = options.input,
                              .config = options.config,
                              .version = ROBOMILL_VERSION};
  if (log_->was_unfinished()) {
    start.message = "the line before was not finished: what wrote it was killed, or the disk was full";
    say(log_->path().string() + ": its last line was not finished; it is ended, and this session follows");
  }
  (void)log_->write(monitor::started_line(start));
}

void EventFile::report_to(live::Notices& notices, live::MetricValues& metrics) {
  notices_ = &notices;
  metrics_ = &metrics;
  if (log_) note(log_->state());
}

void EventFile::note(const io::AppendLog::State& state) {
  if (metrics_ == nullptr) return;
  metrics_->unsaved_events = state.waiting;
  metrics_->lost_events = state.lost;
  metrics_->log_failures = state.failures;
  const bool unsaved = state.error != 0;
  if (unsaved_.exchange(unsaved) == unsaved) return;
  const std::string lost = state.lost > 0 ? fmt::format("; {} were lost", state.lost) : "";
  const std::string text =
      unsaved ? fmt::format("{}: events cannot be saved: {}; the monitor goes on, and they wait", log_->path().string(),
                            io::AppendLog::reason(state.error))
              : fmt::format("{}: events are saved again, those that waited too{}", log_->path().string(), lost);
  say(text);
  notices_->add(unsaved ? "events-not-saved" : "events-saved", text);
}

bool EventFile::write(const std::string& line) {
  if (to_stdout_) {
    if (std::fwrite(line.data(), 1, line.size(), stdout) == line.size() && std::fflush(stdout) == 0) return true;
    failed_ = errno != EPIPE;  // a reader that has seen enough is none of our trouble
    return false;
  }
  if (log_) note(log_->write(line));
  return !whole_ || whole_->write(line);
}

void EventFile::write_beside(const std::string& line) {
  if (log_) note(log_->write(line));
  if (!to_stdout_ || ::ftrylockfile(stdout) != 0) return;
  (void)std::fwrite(line.data(), 1, line.size(), stdout);
  (void)std::fflush(stdout);
  ::funlockfile(stdout);
}

void EventFile::retry() {
  if (!log_ || !unsaved_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - tried_ < retry_pause) return;
  tried_ = now;
  note(log_->retry());
}

void EventFile::close() {
  if (failed_) throw InvalidInput("standard output", "could not be written", "Is the disk full?");
  if (whole_) whole_->close();
}

void EventFile::require_saved() {
  if (!log_) return;
  const io::AppendLog::State state = log_->retry();
  note(state);
  if (state.waiting == 0) return;
  throw InvalidInput(log_->path().string(), fmt::format("{} events could not be saved", state.waiting),
                     io::AppendLog::reason(state.error) + ". Is the disk full?");
}

}  // namespace robomill::app
