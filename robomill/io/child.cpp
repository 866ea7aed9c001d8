#include "robomill/io/child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <fstream>

#include "robomill/io/descriptor.hpp"
#include "robomill/io/sandbox.hpp"
#include "robomill/io/sanitized.hpp"

namespace robomill::io {
namespace {

/// Of the address space, which a child has from its parent; 0: none is known.
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  if (sanitized || !(std::ifstream("/proc/self/statm") >> pages)) return 0;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

[[noreturn]] void be_child(int to, rlim_t most_address_space, const std::function<std::string()>& body, int more_files,
                           const sigset_t& unblocked) {
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
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere >= 0) {
      ::dup2(nowhere, STDERR_FILENO);
      ::close(nowhere);
    }
    static_cast<void>(restrict_files({.connects = false}));
    restrict_to_more_files(more_files);
    if (write_all(to, body()) == 0) status = 0;
  } catch (...) {
    status = 1;
  }
  ::_exit(status);
}

/// Nothing where it cannot be read to its end.
std::optional<std::string> read_whole(int from) {
  std::string bytes;
  std::array<char, 1 << 16> block = {};
  while (true) {
    const ssize_t count = ::read(from, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::optional<std::string> run_in_child(std::size_t more_memory_bytes, const std::function<std::string()>& body,
                                        int more_files) {
  // Here, since a program whose files are restricted may look at its own state, and not at its child's.
  const std::uint64_t now = address_space_bytes();
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  // Until the child has its own, the parent's handlers would remove the parent's files.
  sigset_t every, before;
  ::sigfillset(&every);
  ::pthread_sigmask(SIG_BLOCK, &every, &before);
  const pid_t child = ::fork();
  if (child == 0) be_child(ends[1], now > 0 ? now + more_memory_bytes : 0, body, more_files, before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(ends[1]);
  std::optional<std::string> bytes = child > 0 ? read_whole(ends[0]) : std::nullopt;
  ::close(ends[0]);
  if (child < 0) return std::nullopt;
  int status = 0;
  pid_t ended = -1;
  do {
    ended = ::waitpid(child, &status, 0);
  } while (ended < 0 && errno == EINTR);
  if (ended != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return bytes;
}

}  // namespace robomill::io
