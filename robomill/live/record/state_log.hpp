#pragma once
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "robomill/live/recorded_run.hpp"

namespace robomill::live {

/// The states of a run, one after the other, and how long it was in each.
class StateLog {
 public:
  /// The state from this time on; the first also holds before it. A time before the last one counts as that.
  void add(double time_s, monitor::State state, monitor::BlindReason reason = monitor::BlindReason::none);

  /// From this time on frames were left out, for this reason, or no_signal where time without samples went before.
  void leave_out(double time_s, monitor::BlindReason reason = monitor::BlindReason::gap);
  /// So much more time went by without samples, by the clock, at this time of the stream.
  void silent(double time_s, double seconds);

  [[nodiscard]] const std::vector<Stay>& stays() const { return stays_; }
  /// Stays beyond those listed.
  [[nodiscard]] std::size_t unlisted() const { return unlisted_; }
  /// Of BlindReason::no_signal also the time without samples.
  [[nodiscard]] std::vector<StateTime> times() const;

 private:
  using Key = std::pair<monitor::State, monitor::BlindReason>;
  std::vector<Stay> stays_;
  std::size_t unlisted_ = 0;
  std::map<Key, double> duration_s_;
  Key now_ = {};
  double last_s_ = 0.0;
  double silence_s_ = 0.0;  ///< without samples, since last_s_
};

}  // namespace robomill::live
