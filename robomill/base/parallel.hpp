#pragma once
#include <cstddef>
#include <functional>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// Runs body(begin, end) over blocks that cover [0, n), at most `grain` items a block, on the threads of
/// set_thread_count.
///
/// The blocks are the same at any thread count; body writes results into slots of their own and sums are taken
/// afterwards in fixed order, so results never depend on the number of threads. The first exception that a block throws
/// is thrown again here and no further blocks start.
ROBOMILL_API void parallel_for(std::size_t n, std::size_t grain,
                               const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Threads that parallel_for uses from now on; 0 means one a core.
ROBOMILL_API void set_thread_count(int threads);
/// What parallel_for of this thread uses.
[[nodiscard]] ROBOMILL_API int thread_count();

/// While it lives, this thread's parallel_for uses at most so many.
class ROBOMILL_API ThreadLimit {
 public:
  explicit ThreadLimit(int most);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  int before_;
};

}  // namespace robomill
