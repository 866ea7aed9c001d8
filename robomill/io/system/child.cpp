#include "robomill/io/system/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <thread>

#include "robomill/io/system/descriptor.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/io/system/sanitized.hpp"

namespace robomill::io {
namespace {

using Clock = std::chrono::steady_clock;

/// Of the address space, which a child has from its parent; 0: none is known.
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  if (sanitized || !(std::ifstream("/proc/self/statm") >> pages)) return 0;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Closes all descriptors but the standard ones and two. A kernel before 5.9 cannot, and has no Landlock either.
void keep_only(int one, int other) {
  const auto [first, second] = std::minmax(one, other);
  int next = STDERR_FILENO + 1;
  for (const int kept : {first, second}) {
    if (kept < next) continue;
    if (kept > next) ::close_range(static_cast<unsigned>(next), static_cast<unsigned>(kept - 1), 0);
    next = kept + 1;
  }
  ::close_range(static_cast<unsigned>(next), ~0U, 0);
}

[[noreturn]] void be_child(int to, rlim_t most_address_space, const std::function<std::string()>& body,
                           const ChildLimits& limits, const sigset_t& unblocked) {
  int status = 1;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGPIPE}) ::signal(signal, SIG_DFL);
  ::pthread_sigmask(SIG_SETMASK, &unblocked, nullptr);
  // Whatever ends the parent ends the child.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  try {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    if (most_address_space > 0) {
      const rlimit memory{most_address_space, most_address_space};
      ::setrlimit(RLIMIT_AS, &memory);
    }
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE}) ::signal(signal, SIG_DFL);
    keep_only(to, limits.lent);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere >= 0) {
      ::dup2(nowhere, STDERR_FILENO);
      ::close(nowhere);
    }
    static_cast<void>(restrict_files({.connects = false}));
    restrict_to_more_files(limits.more_files);
    if (write_all(to, body()) == 0) status = 0;
  } catch (...) {
    status = 1;
  }
  ::_exit(status);
}

/// Nothing where it does not come to its end in time, or is longer than it may be.
std::optional<std::string> read_whole(int from, std::size_t most_bytes, Clock::time_point end) {
  std::string bytes;
  std::array<char, 1 << 16> block = {};
  while (bytes.size() <= most_bytes) {
    pollfd waiting = {.fd = from, .events = POLLIN, .revents = 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::clamp<long>(left, 0, 1000)));
    if (ready == 0 && left <= 0) return std::nullopt;
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const ssize_t count = ::read(from, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(count));
  }
  return std::nullopt;
}

/// Waits for its end; whether it ended by itself, in time, and well.
bool ended_well(pid_t child, bool in_time, Clock::time_point end) {
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
    if (in_time && Clock::now() > end) {
      in_time = false;
      ::kill(child, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return in_time && ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::optional<std::string> run_in_child(const ChildLimits& limits, const std::function<std::string()>& body) {
  // Here, since a program whose files are restricted may look at its own state, and not at its child's.
  const std::uint64_t now = address_space_bytes();
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  // Until the child has its own, the parent's handlers would remove the parent's files.
  sigset_t every, before;
  ::sigfillset(&every);
  ::pthread_sigmask(SIG_BLOCK, &every, &before);
  const pid_t child = ::fork();
  if (child == 0) be_child(ends[1], now > 0 ? now + limits.more_memory_bytes : 0, body, limits, before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return std::nullopt;
  }
  const Clock::time_point end = Clock::now() + limits.time;
  std::optional<std::string> bytes;
  try {
    bytes = read_whole(ends[0], limits.more_memory_bytes, end);
  } catch (...) {  // no memory here
    static_cast<void>(ended_well(child, false, end));
    ::close(ends[0]);
    throw;
  }
  ::close(ends[0]);
  return ended_well(child, bytes.has_value(), end) ? bytes : std::nullopt;
}

}  // namespace robomill::io
