#include "robomill/serve/process/worker_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "robomill/base/parallel.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/process/work.hpp"

namespace robomill::serve {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds to_clean_up(300);  ///< for a process that is asked to end: its temporary files go
constexpr milliseconds to_be_reaped(1000);
constexpr milliseconds patience_at_end(500);

/// "200 {…}"
HttpResponse response_of(std::string_view answer) {
  HttpResponse out = {.status = 500};
  const std::size_t blank = std::min(answer.find(' '), answer.size());
  std::from_chars(answer.data(), answer.data() + blank, out.status);
  out.body = answer.substr(std::min(blank + 1, answer.size()));
  return out;
}

/// {"task", "fraction"}; what is no such thing is not reported.
void report_progress(const Progress::Report& report, const std::string& body) {
  if (!report) return;
  const io::Json json = io::Json::parse(body, nullptr, false);
  if (!json.is_object() || !json.contains("task") || !json["task"].is_string()) return;
  const auto fraction = json.find("fraction");
  if (fraction == json.end() || !fraction->is_number()) return;
  report(json["task"].get<std::string>(), fraction->get<double>());
}

std::string what_became(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGKILL) return "its process was killed: perhaps the machine had no memory left";
    return fmt::format("its process crashed (signal {}, {})", signal, ::strsignal(signal));
  }
  return fmt::format("its process ended with exit code {}", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

/// What a process is started with: one end of a pair of sockets, no input, nobody who reads what it prints, and nothing
/// else of the server's: a client's connection would not end before it.
class SpawnActions {
 public:
  explicit SpawnActions(int socket) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_adddup2(&actions_, socket, worker_socket);
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, worker_socket + 1);
    ::posix_spawnattr_init(&attributes_);
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t usual;
    ::sigemptyset(&usual);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGPIPE}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_setsigdefault(&attributes_, &usual);
    // In a group of its own: Ctrl-C is for the server, which then ends it.
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnActions() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;

  /// An error number; 0: it runs.
  int spawn(pid_t& process, std::vector<std::string> command) const {
    std::vector<char*> words;
    words.reserve(command.size() + 1);
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    return ::posix_spawn(&process, words.front(), &actions_, &attributes_, words.data(), environ);
  }

 private:
  posix_spawn_file_actions_t actions_ = {};
  posix_spawnattr_t attributes_ = {};
};

}  // namespace

WorkerProcess::~WorkerProcess() {
  end();
  const std::lock_guard lock(asking_);
  if (process_ > 0) static_cast<void>(reap(true));
}

void WorkerProcess::start() {
  if (was_started_ && options_.remembers) {
    throw WorkerEnded("what the job found is gone with its process; run it again");
  }
  std::array<int, 2> ends = {-1, -1};
  const auto fail = [](int error) {
    throw WorkerEnded(fmt::format("a process for it cannot be started: {}", std::strerror(error)));
  };
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail(errno);
  const int error = SpawnActions(ends[1]).spawn(process_, options_.command);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    process_ = -1;
    fail(error);
  }
  socket_ = ends[0];
  was_started_ = true;
  frames_ = FrameReader(longest_answer);
  const timeval patience = {.tv_sec = 10, .tv_usec = 0};  // for a process that reads nothing
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  const std::string rights = fmt::format("{} {}\n{}", options_.memory_bytes, thread_count(), options_.root.string());
  if (!send_frame(socket_, Frame::begin, rights)) throw WorkerEnded(reap(false));
}

bool WorkerProcess::read(milliseconds look) {
  pollfd waiting = {.fd = socket_, .events = POLLIN, .revents = 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(look.count()));
  if (ready == 0 || (ready < 0 && errno == EINTR)) return true;
  std::array<char, 1 << 16> block;  // NOLINT(cppcoreguidelines-pro-type-member-init): recv fills it
  const ssize_t count = ::recv(socket_, block.data(), block.size(), 0);
  if (count < 0) return errno == EINTR;
  frames_.add({block.data(), static_cast<std::size_t>(count)});
  return count > 0;
}

std::optional<HttpResponse> WorkerProcess::answer_in_what_came(const Question& question) {
  try {
    while (std::optional<Frame> frame = frames_.next()) {
      if (frame->kind == Frame::answer) return response_of(frame->body);
      if (frame->kind == Frame::progress) report_progress(question.report, frame->body);
    }
  } catch (const std::length_error&) {
    static_cast<void>(reap(true));
    throw WorkerEnded("its process said what cannot be understood");
  }
  return std::nullopt;
}

bool WorkerProcess::is_gone_within(milliseconds time, int& status) const {
  constexpr milliseconds step(10);
  for (milliseconds spent(0);; spent += step) {
    const pid_t gone = ::waitpid(process_, &status, WNOHANG);
    if (gone == process_) return true;
    if ((gone < 0 && errno != EINTR) || spent >= time) return false;
    std::this_thread::sleep_for(step);
  }
}

std::string WorkerProcess::reap(bool kill_it) {
  int status = 0;
  ::close(socket_);  // by which it learns that it is to end, too
  socket_ = -1;
  if (kill_it) ::kill(process_, SIGTERM);
  if (!is_gone_within(kill_it ? to_clean_up : to_be_reaped, status)) {
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  process_ = -1;
  return what_became(status);
}

HttpResponse WorkerProcess::ask(const Question& question) {
  const std::lock_guard lock(asking_);
  if (ended_) throw Interrupted();
  if (process_ < 0) start();
  if (!send_frame(socket_, question.kind, question.body)) throw WorkerEnded(reap(false));
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
      static_cast<void>(send_frame(socket_, Frame::stop, {}));  // where that fails the process is gone
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
