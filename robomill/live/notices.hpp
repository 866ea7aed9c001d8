#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::live {

/// A fault of the stream, or another news of it: "lost-blocks", "broker-lost", …
struct Notice {
  std::string what;
  std::uint64_t count = 1;  ///< times since the last notice of the same
  std::string message;      ///< of the last of them
};

/// Gathers notices from any thread. Of each kind one is given at once and then at most one a second, with how many it
/// stands for: a flood of bad messages must not become a flood of events.
class ROBOMILL_API Notices {
 public:
  using Clock = std::chrono::steady_clock;

  void add(const std::string& what, std::string message, std::uint64_t count = 1);
  /// Those that are due. @param all  also those whose second is not over: at the end
  [[nodiscard]] std::vector<Notice> take(Clock::time_point now, bool all = false);

 private:
  struct Kind {
    std::uint64_t count = 0;
    std::string message = {};
    Clock::time_point given = {};
    bool was_given = false;
  };
  std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
};

}  // namespace robomill::live
