#include "robomill/live/hop_queue.hpp"

#include <algorithm>
#include <utility>

namespace robomill::live {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

bool HopQueue::push(Hop&& hop) {
  std::unique_lock lock(mutex_);
  emptied_.wait(lock, [this] { return closed_ || hops_.size() < capacity_; });
  if (closed_) return false;
  hop.arrived = Clock::now();
  hops_.push_back(std::move(hop));
  lock.unlock();
  filled_.notify_one();
  return true;
}

bool HopQueue::offer(Hop& hop) {
  {
    const std::scoped_lock lock(mutex_);
    if (closed_ || hops_.size() >= capacity_) return false;
    hop.arrived = Clock::now();
    hops_.push_back(std::move(hop));
  }
  filled_.notify_one();
  return true;
}

void HopQueue::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  filled_.notify_all();
  emptied_.notify_all();
}

HopQueue::Taken HopQueue::pop(Hop& hop, std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  busy_ = false;
  popped_ = Clock::now();
  filled_.wait_for(lock, wait, [this] { return closed_ || !hops_.empty(); });
  if (hops_.empty()) return closed_ ? Taken::closed : Taken::nothing;
  hop = std::move(hops_.front());
  hops_.pop_front();
  busy_ = true;
  popped_ = Clock::now();
  lock.unlock();
  emptied_.notify_one();
  return Taken::hop;
}

std::size_t HopQueue::size() const {
  const std::scoped_lock lock(mutex_);
  return hops_.size();
}

double HopQueue::stalled_s(Clock::time_point now) const {
  const std::scoped_lock lock(mutex_);
  if (!busy_ && hops_.empty()) return 0.0;
  const Clock::time_point since = busy_ ? popped_ : std::max(popped_, hops_.front().arrived);
  return std::chrono::duration<double>(now - since).count();
}

}  // namespace robomill::live
