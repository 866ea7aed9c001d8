#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace robomill::monitor {

/// The hops that a time takes, at least one.
[[nodiscard]] inline std::size_t hops_of(double seconds, double hop_s) noexcept {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / hop_s)));
}

}  // namespace robomill::monitor
