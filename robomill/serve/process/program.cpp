#include "robomill/serve/process/program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <thread>

#include "robomill/base/parallel.hpp"
#include "robomill/serve/process/frames.hpp"
#include "robomill/serve/process/own_library.hpp"
#include "robomill/serve/process/work.hpp"

namespace robomill::serve {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds to_clean_up(300);  ///< for a process that is asked to end: its temporary files go
constexpr milliseconds to_be_reaped(1000);

std::string what_became(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGKILL) return "its process was killed: perhaps the machine had no memory left";
    return fmt::format("its process crashed (signal {}, {})", signal, ::strsignal(signal));
  }
  return fmt::format("its process ended with exit code {}", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

/// Of the server's environment what such a process needs. Others name services (SSH_AUTH_SOCK), or are secrets.
std::vector<std::string> environment_of_worker() {
  constexpr std::array<std::string_view, 7> needed = {"PATH",          "LANG",         "TZ",      "LD_LIBRARY_PATH",
                                                      "SSL_CERT_FILE", "SSL_CERT_DIR", "LANGUAGE"};
  std::vector<std::string> out;
  for (char** one = environ; one != nullptr && *one != nullptr; ++one) {
    const std::string_view text = *one;
    const std::string_view name = text.substr(0, text.find('='));
    const bool kept = std::ranges::find(needed, name) != needed.end() || name.starts_with("LC_") ||
                      name.ends_with("SAN_OPTIONS");  // of builds with sanitizers
    if (kept) out.emplace_back(text);
  }
  return out;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> out;
  out.reserve(words.size() + 1);
  for (std::string& word : words) out.push_back(word.data());
  out.push_back(nullptr);
  return out;
}

/// What a process is started with: one end of a pair of sockets, the library that it runs from, no input, nobody who
/// reads what it prints, and nothing else of the server's: a client's connection would not end before it.
class SpawnActions {
 public:
  SpawnActions(int socket, int library) : has_library_(library >= 0) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_adddup2(&actions_, socket, worker_socket);
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (has_library_) ::posix_spawn_file_actions_adddup2(&actions_, library, worker_library);
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, has_library_ ? worker_library + 1 : worker_library);
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
    std::vector<std::string> variables = environment_of_worker();
    if (has_library_) variables.push_back(preload_variable(worker_library));
    const std::vector<char*> words = pointers_to(command), environment = pointers_to(variables);
    return ::posix_spawn(&process, words.front(), &actions_, &attributes_, words.data(), environment.data());
  }

 private:
  bool has_library_;
  posix_spawn_file_actions_t actions_ = {};
  posix_spawnattr_t attributes_ = {};
};

}  // namespace

WorkerProgram::WorkerProgram(const WorkerOptions& options) {
  std::array<int, 2> ends = {-1, -1};
  const auto fail = [](int error) {
    throw WorkerEnded(fmt::format("a process for it cannot be started: {}", std::strerror(error)));
  };
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail(errno);
  socket_ = ends[0];
  const int error = SpawnActions(ends[1], options.library).spawn(process_, options.command);
  ::close(ends[1]);
  if (error != 0) {
    ::close(socket_);
    fail(error);
  }
  const timeval patience = {.tv_sec = 10, .tv_usec = 0};  // for a process that reads nothing
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
  const std::string rights = fmt::format("{} {} {} {}\n{}", options.memory_bytes, thread_count(),
                                         options.connects ? 1 : 0, options.last_id, options.root.string());
  if (!send_frame(socket_, Frame::begin, rights)) throw WorkerEnded(end(false));
}

WorkerProgram::~WorkerProgram() {
  if (process_ > 0) static_cast<void>(end(true));
}

WorkerProgram::State WorkerProgram::state_within(milliseconds time, int& status) const {
  constexpr milliseconds step(10);
  for (milliseconds spent(0);; spent += step) {
    const pid_t gone = ::waitpid(process_, &status, WNOHANG);
    if (gone == process_) return State::gone;
    if (gone < 0 && errno != EINTR) return State::unknown;
    if (spent >= time) return State::runs;
    std::this_thread::sleep_for(step);
  }
}

std::string WorkerProgram::end(bool ask_it) {
  int status = 0;
  ::close(socket_);  // by which it learns that it is to end, too
  socket_ = -1;
  State state = state_within(milliseconds(0), status);
  if (state == State::runs && ask_it) ::kill(process_, SIGTERM);
  if (state == State::runs) state = state_within(ask_it ? to_clean_up : to_be_reaped, status);
  const bool killed = state == State::runs;
  if (killed) {
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
  }
  process_ = -1;
  if (killed) return "its process closed its connection, did not end and was killed";
  // Somebody else waited for it, or SIGCHLD is ignored: its number may be another's by now, and is not killed.
  if (state == State::unknown) return "its process is gone, and nobody knows of what";
  return what_became(status);
}

}  // namespace robomill::serve
