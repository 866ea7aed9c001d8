#include "event_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <stdio_ext.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/system/descriptor.hpp"
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

EventFile::EventFile(const Options& options) : options_(options), to_stdout_(options.place == "-") {
  if (to_stdout_ || options.place.empty()) return;
  if (options.is_stream) {
    log_.emplace(options.place, io::AppendLog::Options{.lost_line = monitor::lost_events_line});
  } else {
    whole_.emplace(options.place);
  }
}

void EventFile::begin() {
  if (!log_ || std::exchange(begun_, true)) return;
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  monitor::SessionStart start{.started = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)),
                              .input = options_.input,
                              .config = options_.config,
                              .version = ROBOMILL_VERSION};
  if (log_->was_unfinished()) {
    start.message = "the line before was not finished: what wrote it was killed, or the disk was full";
    say(log_->path().string() + ": its last line was not finished; it is ended, and this session follows");
  }
  (void)log_->write(monitor::started_line(start));
  note();
}

void EventFile::report_to(live::Notices& notices, live::MetricValues& metrics) {
  notices_ = &notices;
  metrics_ = &metrics;
}

/// Of two threads either may come first: both look at the log as it is now. Nothing that may hang is done meanwhile.
void EventFile::note() {
  if (metrics_ == nullptr) return;
  std::vector<std::pair<std::string, std::string>> news;
  {
    const std::scoped_lock lock(noting_);
    const io::AppendLog::State state = log_->state();
    metrics_->unsaved_events = state.waiting;
    metrics_->lost_events = state.lost;
    metrics_->log_failures = state.failures;
    const std::string path = log_->path().string();
    if (std::exchange(moved_, state.moved) != state.moved) {
      news.emplace_back("events-file-moved", path + ": was moved or removed; events go on in another file there");
    }
    const bool unsaved = state.error != 0;
    if (std::exchange(unsaved_, unsaved) != unsaved) {
      const std::string lost = state.lost > 0 ? fmt::format("; {} were lost", state.lost) : "";
      news.emplace_back(unsaved ? "events-not-saved" : "events-saved",
                        unsaved ? fmt::format("{}: events cannot be saved: {}; the monitor goes on, and they wait",
                                              path, io::error_text(state.error))
                                : fmt::format("{}: events are saved again, those that waited too{}", path, lost));
    }
  }
  for (const auto& [what, text] : news) {
    say(text);
    notices_->add(what, text);
  }
}

bool EventFile::write(const std::string& line, bool minor) {
  if (to_stdout_) return print(line);
  if (log_) {
    begin();
    (void)log_->write(line, minor);
    note();
  }
  return !whole_ || whole_->write(line);
}

/// What the system did not take is dropped, and what follows begins a line of its own.
bool EventFile::print(const std::string& line) {
  const std::string text = cut_ ? '\n' + line : line;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) {
    cut_ = false;
    return true;
  }
  const int error = errno;
  if (error == EPIPE) return false;  // a reader that has seen enough is none of our trouble
  ::__fpurge(stdout);
  std::clearerr(stdout);
  cut_ = true;
  if (unprinted_++ == 0 && options_.is_stream) {
    say("standard output takes no events: " + io::error_text(error) + "; the monitor goes on without them");
  }
  return options_.is_stream;
}

void EventFile::write_beside(const std::string& line) {
  if (log_) {
    (void)log_->write(line);
    note();
  }
  if (!to_stdout_ || ::ftrylockfile(stdout) != 0) return;
  (void)std::fwrite(line.data(), 1, line.size(), stdout);
  (void)std::fflush(stdout);
  ::funlockfile(stdout);
}

void EventFile::retry() {
  if (!log_ || log_->state().waiting == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - tried_ < retry_pause) return;
  tried_ = now;
  (void)log_->retry();
  note();
}

void EventFile::close() {
  if (unprinted_ > 0 && !options_.is_stream) {
    throw InvalidInput("standard output", "could not be written", "Is the disk full?");
  }
  if (whole_) whole_->close();
}

void EventFile::require_saved() {
  if (unprinted_ > 0) {
    throw InvalidInput("standard output", fmt::format("{} events could not be written", unprinted_),
                       "Is the disk full?");
  }
  if (!log_) return;
  const io::AppendLog::State state = log_->close();
  note();
  if (state.waiting == 0 && state.error == 0) return;
  const std::string rule = state.waiting > 0 ? fmt::format("{} events could not be saved", state.waiting)
                                             : std::string("may lack events after a power cut");
  throw InvalidInput(log_->path().string(), rule, io::error_text(state.error) + ". Is the disk full?");
}

}  // namespace robomill::app
