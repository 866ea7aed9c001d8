#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace robomill::io {

/// What body returns, run in a child process that may take so much more memory and has no standard error: for libraries
/// that a damaged file brings down. Nothing where the child died or body threw. Sanitized builds know no limit of
/// memory.
[[nodiscard]] std::optional<std::string> run_in_child(std::size_t more_memory_bytes,
                                                      const std::function<std::string()>& body);

}  // namespace robomill::io
