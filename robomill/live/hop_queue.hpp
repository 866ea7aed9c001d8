#pragma once
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::live {

/// Samples of one hop on their way from the input to the detector.
struct Hop {
  std::vector<float> samples;  ///< channels interleaved
  double spindle_speed_rad_per_s = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t frames_before = 0;                     ///< frames left out between the hop before and this
  bool dropped = false;                                ///< some of these since the queue had no room
  bool restarted = false;                              ///< what was before this has nothing to do with it
  std::chrono::steady_clock::time_point arrived = {};  ///< in the queue
};

/// A queue of bounded length between the thread that reads the input and the one that processes it.
class ROBOMILL_API HopQueue {
 public:
  explicit HopQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Waits for room; false once closed.
  bool push(Hop&& hop);
  /// Does not wait; false, and the hop stays with the caller, where there is no room or the queue is closed.
  bool offer(Hop& hop);
  /// No more hops; what is in it can still be taken.
  void close();

  enum class Taken {
    hop,      ///< the oldest hop was taken
    nothing,  ///< none came within the time; more may come
    closed    ///< closed and empty: nothing follows
  };
  /// The hop taken before is done with.
  Taken pop(Hop& hop, std::chrono::milliseconds wait);
  [[nodiscard]] std::size_t size() const;
  /// For how long [s] there has been a hop to process and no call of pop() began or ended.
  [[nodiscard]] double stalled_s(std::chrono::steady_clock::time_point now) const;
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, emptied_;
  std::deque<Hop> hops_;
  std::chrono::steady_clock::time_point popped_ = {};  ///< when pop() began or ended last
  bool busy_ = false;                                  ///< with the hop taken last
  bool closed_ = false;
};

}  // namespace robomill::live
