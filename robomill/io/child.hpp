#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace robomill::io {

/// What body returns, run in a child process that may take so much more memory, has no standard error, and where the
/// kernel has Landlock opens no file but those in memory: for libraries that a damaged file brings down, or that open
/// whatever files a file names. Nothing where the child died or body threw. Sanitized builds know no limit of memory.
/// @param more_files  that it may have open at a time, with or without Landlock
[[nodiscard]] std::optional<std::string> run_in_child(std::size_t more_memory_bytes,
                                                      const std::function<std::string()>& body, int more_files = 0);

}  // namespace robomill::io
