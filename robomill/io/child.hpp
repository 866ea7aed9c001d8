#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace robomill::io {

/// What body returns, run in a child process that may take so much more memory, has no standard error, and opens one
/// file at a time, `readable` alone where the kernel has Landlock: for libraries that a damaged file brings down, or
/// that open whatever files a file names. Nothing where the child died or body threw. Sanitized builds know no limit of
/// memory.
/// @param readable  empty: no file
[[nodiscard]] std::optional<std::string> run_in_child(std::size_t more_memory_bytes,
                                                      const std::function<std::string()>& body,
                                                      const std::filesystem::path& readable = {});

}  // namespace robomill::io
