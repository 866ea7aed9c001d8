#include "robomill/serve/process/worker_process.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "robomill/io/json.hpp"
#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds patience_at_end(500);

/// {"task", "fraction"}; what is no such thing is not reported.
void report_progress(const Progress::Report& report, const std::string& body) {
  if (!report) return;
  const io::Json json = io::parsed_or_discarded(body);
  if (!json.is_object() || !json.contains("task") || !json["task"].is_string()) return;
  const auto fraction = json.find("fraction");
  if (fraction == json.end() || !fraction->is_number()) return;
  report(json["task"].get<std::string>(), fraction->get<double>());
}

}  // namespace

WorkerProcess::~WorkerProcess() {
  end();
  const std::lock_guard lock(asking_);
  program_.reset();
}

void WorkerProcess::start() {
  if (was_started_ && remembers_) throw WorkerEnded("what the job found is gone with its process; run it again");
  was_started_ = true;
  frames_ = FrameReader(longest_answer);
  program_ = std::make_unique<WorkerProgram>(options_);
}

bool WorkerProcess::is_gone() const {
  char next = 0;
  const ssize_t count = ::recv(program_->socket(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

bool WorkerProcess::read(milliseconds look) {
  pollfd waiting = {.fd = program_->socket(), .events = POLLIN, .revents = 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(look.count()));
  if (ready == 0 || (ready < 0 && errno == EINTR)) return true;
  std::array<char, 1 << 16> block;  // NOLINT(cppcoreguidelines-pro-type-member-init): recv fills it
  const ssize_t count = ::recv(program_->socket(), block.data(), block.size(), 0);
  if (count < 0) return errno == EINTR;
  frames_.add({block.data(), static_cast<std::size_t>(count)});
  return count > 0;
}

std::optional<HttpResponse> WorkerProcess::answer_in_what_came(const Question& question) {
  try {
    while (std::optional<Frame> frame = frames_.next()) {
      if (frame->kind == Frame::answer) {
        open_ = false;
        return response_of(frame->body);
      }
      if (frame->kind == Frame::progress) report_progress(question.report, frame->body);
    }
  } catch (const std::length_error&) {
    static_cast<void>(reap(true));
    throw WorkerEnded("its process said what cannot be understood");
  }
  return std::nullopt;
}

std::string WorkerProcess::reap(bool kill_it) {
  const std::unique_ptr<WorkerProgram> ending = std::move(program_);
  return ending->end(kill_it);
}

HttpResponse WorkerProcess::ask(const Question& question) {
  const std::lock_guard lock(asking_);
  if (ended_) throw Interrupted();
  try {
    return answer_to(question);
  } catch (...) {
    // No memory here, or a report that throws: the next question would get the answer of this one.
    if (program_ && open_) static_cast<void>(reap(true));
    throw;
  }
}

HttpResponse WorkerProcess::answer_to(const Question& question) {
  if (program_ && is_gone()) program_.reset();  // while nobody asked it
  if (!program_) start();
  open_ = true;
  if (!send_frame(program_->socket(), question.kind, question.body)) throw WorkerEnded(reap(false));
  const Clock::time_point last = Clock::now() + question.most;
  std::optional<Clock::time_point> deadline = {};
  bool too_long = false;
  for (;;) {
    const bool there = read(question.look);
    if (std::optional<HttpResponse> answer = answer_in_what_came(question)) {
      if (answer->status != 409) return *std::move(answer);
      if (!too_long) throw Interrupted();
      break;
    }
    if (!there) throw WorkerEnded(reap(false));
    const Clock::time_point now = Clock::now();
    if (!deadline) {
      too_long = now >= last;
      if (!too_long && !ended_ && !(question.stopped && question.stopped())) continue;
      static_cast<void>(send_frame(program_->socket(), Frame::stop, {}));  // where that fails the process is gone
      deadline = now + question.patience;
    }
    if (ended_) deadline = std::min(*deadline, now + patience_at_end);
    if (now < *deadline) continue;
    static_cast<void>(reap(true));
    if (!too_long) throw Interrupted();
    break;
  }
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(question.most).count();
  throw WorkerEnded(fmt::format("it took longer than {} s and was stopped", seconds));
}

std::string live_answer(WorkerProcess& process, char kind, std::string_view body, const Progress& progress) {
  const auto stopped = [&progress] {
    try {
      progress.check();
    } catch (const Interrupted&) {
      return true;
    }
    return false;
  };
  HttpResponse answer = process.ask(
      {.kind = kind, .body = body, .stopped = stopped, .look = milliseconds(4), .patience = std::chrono::seconds(60)});
  if (answer.status != 200) throw AnsweredElsewhere(std::move(answer));
  return std::move(answer.body);
}

}  // namespace robomill::serve
