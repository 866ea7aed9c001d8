#include "robomill/live/notices.hpp"

#include <utility>

namespace robomill::live {

void Notices::add(const std::string& what, std::string message, std::uint64_t count) {
  const std::scoped_lock lock(mutex_);
  Kind& kind = kinds_[what];
  kind.count += count;
  kind.message = std::move(message);
}

std::vector<Notice> Notices::take(Clock::time_point now, bool all) {
  std::vector<Notice> due;
  const std::scoped_lock lock(mutex_);
  for (auto& [what, kind] : kinds_) {
    const bool early = kind.was_given && now - kind.given < std::chrono::seconds(1);
    if (kind.count == 0 || (early && !all)) continue;
    due.push_back({.what = what, .count = std::exchange(kind.count, 0), .message = kind.message});
    kind.given = now;
    kind.was_given = true;
  }
  return due;
}

}  // namespace robomill::live
