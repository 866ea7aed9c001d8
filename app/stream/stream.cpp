#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/path/files/stream_json.hpp"
#include "robomill/path/interpolator.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/setpoint_stream.hpp"
#include "stream/command_intake.hpp"
#include "stream/setpoint_writer.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using path::PathInterpolator;
using path::SetpointStream;
using path::StreamedProgram;
using path::StreamEnd;

/// How long the planner sleeps where the look-ahead is full, of 4 s.
constexpr std::chrono::milliseconds planner_nap(5);
/// Between two looks at the signal, and at what is to be reported.
constexpr std::chrono::milliseconds watch_period(20);
/// Warnings that repeat.
constexpr std::chrono::seconds warning_period(1);
/// What coming to rest, the last lines and the report may take after Ctrl-C, and the lines alone.
constexpr double ending_s = 10.0;
constexpr std::chrono::seconds reader_patience(2);

/// Signals are the main thread's; a pipe that has no reader is an error of write().
void block_signals() {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

/// Pushes the blocks of a program as the look-ahead takes them.
class Planner {
 public:
  Planner(jobs::OpenedStream& opened, PathInterpolator& path) : opened_(&opened), path_(&path) {}

  /// Until the look-ahead is full; false: nothing follows.
  bool fill() {
    try {
      return push();
    } catch (const InvalidInput& error) {
      failure_ = error.what();
      return false;
    }
  }
  /// A thread's work. What a failure leaves ends at rest.
  void run(SetpointStream& stream) {
    while (!stream.ended() && fill()) std::this_thread::sleep_for(planner_nap);
    if (!failure_.empty()) stream.stop();
  }
  [[nodiscard]] const std::string& failure() const { return failure_; }

 private:
  using Pushed = PathInterpolator::Pushed;

  bool push() {
    for (;;) {
      if (!has_block_ && !whole_) {
        whole_ = !opened_->program->next(block_);
        has_block_ = !whole_;
      }
      const Pushed pushed = whole_ ? path_->finish() : path_->push(block_, gamma_rad(pushed_ + 1));
      if (pushed.status == Pushed::Status::full) return true;
      if (!pushed.accepted()) {
        if (pushed.status != Pushed::Status::closed) failure_ = text_of(pushed);
        return false;
      }
      if (whole_) return false;
      has_block_ = false;
      ++pushed_;
    }
  }
  [[nodiscard]] double gamma_rad(std::size_t boundary) const {
    const std::vector<double>& all = opened_->posture.gamma_rad;
    if (all.empty()) return 0.0;
    return all[std::min(boundary, all.size() - 1)];
  }
  [[nodiscard]] std::string text_of(const Pushed& pushed) const {
    const std::string program = opened_->program_name + ": ";
    if (pushed.status == Pushed::Status::unreachable) {
      return program + path::cannot_take(pushed.reach, *opened_->machine, pushed.block, pushed.line).what();
    }
    return program + fmt::format("block {} (line {}) {}", pushed.block + 1, pushed.line,
                                 pushed.status == Pushed::Status::antipodal
                                     ? "turns the axis by half a circle, to where no one way leads"
                                     : "is invalid");
  }

  jobs::OpenedStream* opened_;
  PathInterpolator* path_;
  program::Block block_ = {};
  bool has_block_ = false, whole_ = false;
  std::size_t pushed_ = 0;
  std::string failure_ = {};
};

/// Carries commands out, and counts them.
class Operator {
 public:
  explicit Operator(SetpointStream& stream) : stream_(&stream) {}

  std::string answer(std::optional<std::string_view> line) {
    const ParsedCommand parsed =
        line ? parse_command(*line)
             : ParsedCommand{.command = {},
                             .error = fmt::format("a command has at most {} bytes", CommandLines::longest)};
    if (!parsed.error.empty()) {
      ++rejected;
      return "error: " + parsed.error;
    }
    if (!parsed.command) return {};
    ++carried_out;
    switch (parsed.command->kind) {
      case StreamCommand::Kind::hold:
        stream_->hold();
        return "ok hold";
      case StreamCommand::Kind::resume:
        stream_->resume();
        return "ok resume";
      case StreamCommand::Kind::feed_override:
        stream_->set_override(parsed.command->share);
        return fmt::format("ok override {:.6g}", parsed.command->share);
      case StreamCommand::Kind::stop:
        stream_->stop();
        stopped = true;
        return "ok stop";
      case StreamCommand::Kind::status:
        break;
    }
    return fmt::format("ok {}, {} set-points, {} misses, {} starved, {} overruns",
                       name_in(path::interpolator_state_names, stream_->state()), stream_->periods(), stream_->misses(),
                       stream_->starved(), stream_->overruns());
  }

  std::uint64_t carried_out = 0, rejected = 0;
  bool stopped = false;

 private:
  SetpointStream* stream_;
};

/// Says on standard error what goes wrong while it runs: at once, then once a second at most.
class Watcher {
 public:
  explicit Watcher(const SetpointStream& stream) : stream_(&stream) {}

  void look() {
    const bool held = stream_->held_for_reader();
    if (held != held_) {
      held_ = held;
      std::fputs(held ? "robomill: the reader of the set-points is behind: the motion holds\n"
                      : "robomill: the reader of the set-points has caught up: the motion goes on\n",
                 stderr);
    }
    const auto now = std::chrono::steady_clock::now();
    if (now - said_at_ < warning_period) return;
    const std::uint64_t misses = stream_->misses(), starved = stream_->starved(), overruns = stream_->overruns();
    if (misses == misses_ && starved == starved_ && overruns == overruns_) return;
    fmt::print(stderr, "{}{} deadline misses, {} starved set-points, {} overruns of {} set-points so far\n",
               io::warning_label, misses, starved, overruns, stream_->periods());
    misses_ = misses;
    starved_ = starved;
    overruns_ = overruns;
    said_at_ = now;
  }

 private:
  const SetpointStream* stream_;
  std::chrono::steady_clock::time_point said_at_ = {};
  std::uint64_t misses_ = 0, starved_ = 0, overruns_ = 0;
  bool held_ = false;
};

/// Whatever happens: the path comes to rest, so that the threads end.
class Ending {
 public:
  Ending(SetpointStream& stream, SetpointWriter& writer) : stream_(&stream), writer_(&writer) {}
  ~Ending() {
    stream_->stop();
    if (!regular) writer_->give_up();
  }
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;
  bool regular = false;

 private:
  SetpointStream* stream_;
  SetpointWriter* writer_;
};

/// Until all set-points are written.
/// @returns whether a signal ended it
bool run_threads(SetpointStream& stream, Planner& planner, SetpointWriter& writer, CommandIntake& intake,
                 StreamedProgram& streamed) {
  const std::atomic<bool>& stop = stop_on_signal();
  std::atomic<bool> written{false};
  bool interrupted = false;
  const double period_s = streamed.report.period_s;
  std::jthread writing([&] {
    block_signals();
    path::Scheduling behind;
    path::schedule_first(behind, 1);
    writer.run(stream, period_s);
    written = true;
  });
  std::jthread planning([&] {
    block_signals();
    planner.run(stream);
  });
  std::jthread loop([&] {
    block_signals();
    path::schedule_first(streamed.scheduling);
    path::MonotonicClock clock;
    stream.run(clock);
  });
  Ending ending(stream, writer);
  Watcher watcher(stream);
  std::optional<std::chrono::steady_clock::time_point> ended_at;
  while (!written) {
    intake.poll(watch_period);
    watcher.look();
    if (stop && !interrupted) {
      interrupted = true;
      take_time_to_end(ending_s);
      stream.stop();
    }
    const auto now = std::chrono::steady_clock::now();
    if (stream.ended() && !ended_at) ended_at = now;
    if (interrupted && ended_at && now - *ended_at > reader_patience) writer.give_up();
  }
  ending.regular = true;
  return interrupted;
}

jobs::OpenedStream open(const jobs::VerbJob& job, Progress& progress) {
  try {
    return jobs::open_stream({.program = job.input(), .cell = job.file("cell"), .near_deg = job.numbers("posture_deg")},
                             progress);
  } catch (const InvalidInput& error) {
    throw job.about_option(error, "--posture", "posture_deg", 1.0);
  }
}

void say(const jobs::OpenedStream& opened) {
  for (const std::string& note : opened.notes) fmt::print(stderr, "{}\n", printable(note));
}

/// Exit code 0: only at the program's end, or by command.
Exit exit_of(const StreamedProgram& streamed) {
  switch (streamed.end) {
    case StreamEnd::finished:
    case StreamEnd::stopped:
      return done;
    case StreamEnd::interrupted:
      return static_cast<Exit>(exit_of_signal());
    case StreamEnd::failed:
      break;
  }
  fmt::print(stderr, "robomill: {}\n", printable_lines(streamed.failure));
  return bad_input;
}

StreamEnd end_of(const StreamedProgram& streamed, bool interrupted) {
  if (!streamed.failure.empty()) return StreamEnd::failed;
  if (streamed.report.state == PathInterpolator::State::finished) return StreamEnd::finished;
  return interrupted ? StreamEnd::interrupted : StreamEnd::stopped;
}

void report(const Common& common, const StreamedProgram& streamed) {
  const std::string text = path::stream_text(streamed) + assumed_text(streamed.assumed);
  if (!common.quiet) {
    fmt::print(stderr, "{}", text);
  } else if (streamed.report.misses + streamed.report.starved + streamed.report.overruns > 0) {
    fmt::print(stderr, "{}{} deadline misses, {} starved set-points, {} overruns of {} set-points\n", io::warning_label,
               streamed.report.misses, streamed.report.starved, streamed.report.overruns, streamed.report.periods);
  }
  if (common.report.empty()) return;
  page::Report page;
  page.title = "Set-points by the clock";
  page.notes = streamed.notes;
  page.assumed = streamed.assumed;
  page.summary = text;
  write_report(common.report, page, path::stream_json(streamed));
}

}  // namespace

Exit run_stream(const jobs::VerbJob& job, const Common& common, Progress& progress) {
  jobs::OpenedStream opened = open(job, progress);
  const path::SmoothingOptions& smoothing = opened.smoothing.options;
  const double period_s = smoothing.sample_period_s;
  const std::vector<double>& gamma_rad = opened.posture.gamma_rad;
  SetpointWriter writer(common.output, opened.machine->joints());
  PathInterpolator path(*opened.machine, smoothing, opened.program->start(), gamma_rad.empty() ? 0.0 : gamma_rad[0],
                        opened.posture.start);
  SetpointStream stream(path, {.period_s = period_s});
  if (job.flag("held")) stream.hold();
  Operator commands(stream);
  CommandIntake intake(
      {.input = STDIN_FILENO, .listen = job.text("listen")},
      [&](std::optional<std::string_view> line) { return commands.answer(line); },
      [&](const std::string& answer) {
        const bool bad = answer.starts_with("error");
        if (bad || !common.quiet) fmt::print(stderr, "{}\n", answer);
      });
  if (!common.quiet) say(opened);
  if (!intake.address().empty() && !common.quiet) fmt::print(stderr, "commands at {}\n", printable(intake.address()));
  if (intake.is_public()) {
    fmt::print(stderr, "{}whoever reaches {} commands the motion: there is no password\n", io::warning_label,
               intake.address());
  }
  StreamedProgram streamed{.program = opened.program_name, .cell = opened.cell.path.filename().string()};
  streamed.report.period_s = period_s;
  // What is planned before the first period need not be waited for.
  Planner planner(opened, path);
  if (!planner.fill() && !planner.failure().empty()) throw InvalidInput(planner.failure(), "nothing was streamed");
  path::lock_memory(streamed.scheduling);
  const bool interrupted = run_threads(stream, planner, writer, intake, streamed);
  streamed.report = stream.report();
  streamed.written = writer.written();
  streamed.commands = commands.carried_out;
  streamed.rejected_commands = commands.rejected;
  streamed.notes = std::move(opened.notes);
  streamed.assumed = std::move(opened.assumed);
  streamed.failure = !planner.failure().empty() ? planner.failure() : writer.failure();
  try {
    if (writer.failure().empty()) writer.close();
  } catch (const InvalidInput& error) {
    streamed.failure = error.what();
  }
  streamed.end = end_of(streamed, interrupted);
  report(common, streamed);
  return exit_of(streamed);
}

}  // namespace robomill::app
