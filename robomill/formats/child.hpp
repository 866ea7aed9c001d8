#pragma once
#include <functional>
#include <optional>
#include <string>

namespace robomill::formats {

/// What body returns, run in a child process without standard error: for libraries that a damaged file brings down.
/// Nothing where the child died or body threw.
[[nodiscard]] std::optional<std::string> run_in_child(const std::function<std::string()>& body);

}  // namespace robomill::formats
