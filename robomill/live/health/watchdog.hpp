#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "robomill/live/hop_queue.hpp"

// Method: robomill/live/README.md, "Method"

namespace robomill::live {

/// Looks from a thread of its own whether the one that takes hops out of a queue goes on.
class Watchdog {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param stalled  called by that thread ten times a second while a hop has waited for longer than Load::longest_s
  /// and
  ///     nothing was taken: for how long more than at the call before, and whether this is the first of a stall
  /// @param now      what the queue's time is compared with
  Watchdog(const HopQueue& queue, std::function<void(double more_s, bool begins)> stalled,
           std::function<Clock::time_point()> now = Clock::now);
  /// Waits for a call that is under way.
  ~Watchdog() = default;
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

 private:
  void run(const std::stop_token& stop);

  const HopQueue* queue_;
  std::function<void(double, bool)> stalled_;
  std::function<Clock::time_point()> now_;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread thread_;
};

}  // namespace robomill::live
