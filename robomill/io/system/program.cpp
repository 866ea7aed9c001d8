#include "robomill/io/system/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {
namespace {

using ProgramClock = std::chrono::steady_clock;

/// What it is started with: no input, and two pipes.
class ProgramActions {
 public:
  ProgramActions(int out, int error) {
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawn_file_actions_addopen(&files_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files_, out, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&files_, error, STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&files_, STDERR_FILENO + 1);
    ::posix_spawnattr_init(&attributes_);
    sigset_t none, usual;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::sigemptyset(&usual);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGPIPE}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_setsigdefault(&attributes_, &usual);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~ProgramActions() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  ProgramActions(const ProgramActions&) = delete;
  ProgramActions& operator=(const ProgramActions&) = delete;

  [[nodiscard]] int spawn(pid_t& process, std::vector<std::string>& words) const {
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return ::posix_spawnp(&process, pointers.front(), &files_, &attributes_, pointers.data(), environ);
  }

 private:
  posix_spawn_file_actions_t files_ = {};
  posix_spawnattr_t attributes_ = {};
};

/// False at the end of what there is to read.
bool read_some(int from, std::string& into, std::size_t most_bytes) {
  std::array<char, 1 << 14> block = {};
  const ssize_t count = ::read(from, block.data(), block.size());
  if (count < 0) return errno == EINTR;
  into.append(block.data(), std::min(static_cast<std::size_t>(count), most_bytes - std::min(most_bytes, into.size())));
  return count > 0;
}

/// Until both ends are closed; false where the time is over before.
bool read_both(std::array<Descriptor, 2>& from, ProgramEnd& into, std::size_t most_bytes,
               ProgramClock::time_point end) {
  while (from[0].is_open() || from[1].is_open()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - ProgramClock::now()).count();
    if (left <= 0) return false;
    std::array<pollfd, 2> waits = {{{from[0].get(), POLLIN, 0}, {from[1].get(), POLLIN, 0}}};  // -1: left out
    if (::poll(waits.data(), waits.size(), static_cast<int>(left)) < 0 && errno != EINTR) return false;
    for (std::size_t i = 0; i < waits.size(); ++i) {
      if (waits[i].revents == 0) continue;
      if (!read_some(from[i].get(), i == 0 ? into.said : into.complaint, most_bytes))
        static_cast<void>(from[i].close());
    }
  }
  return true;
}

}  // namespace

ProgramEnd run_program(std::vector<std::string> words, const ProgramLimits& limits) {
  ProgramEnd out;
  std::array<int, 2> said = {-1, -1}, complaint = {-1, -1};
  if (::pipe2(said.data(), O_CLOEXEC) != 0) return {.complaint = error_text(errno)};
  std::array<Descriptor, 2> from = {Descriptor(said[0]), Descriptor()};
  Descriptor to_said(said[1]);
  if (::pipe2(complaint.data(), O_CLOEXEC) != 0) return {.complaint = error_text(errno)};
  from[1] = Descriptor(complaint[0]);
  Descriptor to_complaint(complaint[1]);
  pid_t process = -1;
  if (const int error = ProgramActions(said[1], complaint[1]).spawn(process, words); error != 0) {
    return {.complaint = error_text(error)};
  }
  out.started = true;
  static_cast<void>(to_said.close());
  static_cast<void>(to_complaint.close());
  if (!read_both(from, out, limits.output_bytes, ProgramClock::now() + limits.time)) ::kill(process, SIGKILL);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  out.code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return out;
}

}  // namespace robomill::io
