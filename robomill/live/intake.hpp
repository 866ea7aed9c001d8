#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "robomill/live/hop_queue.hpp"

namespace robomill::live {

/// Cuts samples into hops and puts them into a queue. Used by one thread.
///
/// A source that can wait (a file) does so where the queue is full. From one that cannot, whole hops are left out then:
/// `dropped` is reported, and the next hop says how many frames are missing before it.
class Intake {
 public:
  /// @param dropped  called with 1 for every hop that is left out
  Intake(HopQueue& queue, std::size_t channels, std::size_t hop_frames, bool can_wait,
         std::function<void(std::uint64_t hops)> dropped);

  void speed(double rad_per_s) { filling_.spindle_speed_rad_per_s = rad_per_s; }
  /// Frames of all channels. False once the queue is closed to a source that can wait.
  bool add(std::span<const float> samples);
  /// Frames that were lost on their way: up to `most_filled` become NaN, so that time and phase run on; more are left
  /// out together with the hop begun.
  bool gap(std::uint64_t frames, std::uint64_t most_filled);
  /// What comes has nothing to do with what was before.
  void restart();
  /// What is left of a hop goes on its way.
  bool finish();

 private:
  bool hand_over();

  HopQueue* queue_;
  std::size_t channels_, hop_samples_;
  bool can_wait_;
  std::function<void(std::uint64_t)> dropped_;
  Hop filling_;
};

}  // namespace robomill::live
