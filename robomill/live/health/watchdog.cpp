#include "robomill/live/health/watchdog.hpp"

#include <chrono>
#include <utility>

#include "robomill/live/health/load.hpp"

namespace robomill::live {
namespace {

constexpr std::chrono::milliseconds period{100};

}  // namespace

Watchdog::Watchdog(const HopQueue& queue, std::function<void(double more_s, bool begins)> stalled,
                   std::function<Clock::time_point()> now)
    : queue_(&queue),
      stalled_(std::move(stalled)),
      now_(std::move(now)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

void Watchdog::run(const std::stop_token& stop) {
  double counted_s = 0.0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      ended_.wait_for(lock, stop, period, [] { return false; });
    }
    if (stop.stop_requested()) return;
    const double stalled_s = queue_->stalled_s(now_());
    if (stalled_s < Load::longest_s) {
      counted_s = 0.0;
      continue;
    }
    stalled_(stalled_s - counted_s, counted_s == 0.0);
    counted_s = stalled_s;
  }
}

}  // namespace robomill::live
