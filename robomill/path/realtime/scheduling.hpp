#pragma once
#include <string>

#include "robomill/base/export.hpp"

// Method: robomill/path/README.md, "Set-points by the clock"

namespace robomill::path {

/// What the system grants to a thread that runs by the clock.
struct Scheduling {
  bool first_in_first_out = false;  ///< SCHED_FIFO
  int priority = 0;                 ///< of it
  std::string why_not = {};         ///< in words, where it is not
  bool memory_locked = false;       ///< mlockall: no page of the process is read from the disk
  std::string why_not_locked = {};  ///< in words, where it is not
};

/// Of the thread that calls: SCHED_FIFO, and sleeps that end without the slack that timers have otherwise.
/// @param below  0 of the loop; a thread behind it that is woken by it, such as its reader, 1
ROBOMILL_API void schedule_first(Scheduling& out, int below = 0);
/// Of the process, all that it takes later too: only where it may lock as much as it likes, since an allocation beyond
/// a limit would fail.
ROBOMILL_API void lock_memory(Scheduling& out);

}  // namespace robomill::path
