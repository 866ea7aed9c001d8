#pragma once
#include <chrono>

#include "robomill/live/hop_queue.hpp"

namespace robomill::live {

/// Whether decisions keep up with the samples. From the first hop that waited on, the clock's time is compared with the
/// stream's, until the queue is empty: a source that is kept waiting, and runs faster than its samples were taken, is
/// not late. Used by the thread that takes the hops.
class Load {
 public:
  using Clock = std::chrono::steady_clock;
  /// By how much decisions may be behind the samples.
  static constexpr double longest_s = 1.0;
  /// Late by less than this they have caught up, where the queue never empties.
  static constexpr double caught_up_s = 0.1;

  /// @param by_clock     whether samples come by the clock; otherwise none is late
  /// @param look_back_s  MonitorOptions::look_back_s()
  Load(bool by_clock, double look_back_s) : by_clock_(by_clock), look_back_s_(look_back_s) {}
  /// A hop was taken out of the queue.
  /// @param stream_s  where it begins; what was left out before it counts
  /// @param drained   nothing else waits
  void take(const Hop& hop, double stream_s, bool drained, Clock::time_point now);
  /// Nothing was taken for longer than longest_s. A source that had been kept waiting until then, ahead of the clock,
  /// owes it nothing for that time.
  void stalled();
  /// Decisions are late, or hops were left out; until they have caught up and all that a decision looks back at came.
  [[nodiscard]] bool overloaded() const { return overloaded_; }
  [[nodiscard]] double behind_s() const { return behind_s_; }

 private:
  bool by_clock_;
  double look_back_s_;
  bool overloaded_ = false, drained_ = true;
  bool anew_ = false;            ///< the next hop is the first from which the clock's time counts
  Clock::time_point from_ = {};  ///< when the first hop came that waited …
  double from_s_ = 0.0;          ///< … and where it began
  double ahead_s_ = 0.0;         ///< by how much the stream had run further than the clock
  double behind_s_ = 0.0, whole_from_s_ = 0.0;
};

}  // namespace robomill::live
