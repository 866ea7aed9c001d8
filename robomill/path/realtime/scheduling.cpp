#include "robomill/path/realtime/scheduling.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>

#include "robomill/io/system/descriptor.hpp"

namespace robomill::path {
namespace {

/// Above other work of a normal system, below the kernel's own threads that serve interrupts and clocks (50, 99).
constexpr int stream_priority = 40;

}  // namespace

void schedule_first(Scheduling& out, int below) {
  // A thread without SCHED_FIFO would be woken up to 50 us late on purpose.
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  sched_param param = {};
  param.sched_priority = stream_priority - below;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &param);
  out.first_in_first_out = error == 0;
  out.priority = error == 0 ? param.sched_priority : 0;
  out.why_not = error == 0 ? "" : fmt::format("{} (root, CAP_SYS_NICE or ulimit -r)", io::error_text(error));
}

void lock_memory(Scheduling& out) {
  rlimit limit = {};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY && ::geteuid() != 0) {
    out.why_not_locked = fmt::format("{} kB may be locked (root or ulimit -l unlimited)", limit.rlim_cur / 1024);
    return;
  }
  out.memory_locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!out.memory_locked) out.why_not_locked = io::error_text(errno);
}

}  // namespace robomill::path
