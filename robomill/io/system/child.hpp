#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace robomill::io {

/// What a child process may do.
struct ChildLimits {
  std::size_t more_memory_bytes =
      0;  ///< than its parent has, and of its answer; sanitized builds limit the answer alone
  std::chrono::milliseconds time{30'000};  ///< by the clock; then it is killed
  int lent = -1;                           ///< a descriptor that it keeps beside input and output
  int more_files = 0;                      ///< that it may have open at a time, with or without Landlock
};

/// What body returns, run in a child process that has no standard error, none of its parent's open files, and where the
/// kernel has Landlock opens no file but those in memory: for libraries that a damaged file brings down or keeps busy
/// for ever, or that open whatever files a file names. Nothing where the child died, body threw, or a limit was
/// reached.
[[nodiscard]] std::optional<std::string> run_in_child(const ChildLimits& limits,
                                                      const std::function<std::string()>& body);

}  // namespace robomill::io
