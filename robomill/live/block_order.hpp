#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "robomill/monitor/files/stream_block.hpp"

namespace robomill::live {

/// What happened to the blocks of a stream on their way.
struct OrderCounts {
  std::uint64_t lost = 0;       ///< never came, or came too late
  std::uint64_t doubled = 0;    ///< came again
  std::uint64_t late = 0;       ///< came after they had been given up
  std::uint64_t reordered = 0;  ///< came behind a later one and were put back
  std::uint64_t restarts = 0;   ///< the sender counts from elsewhere
};

/// Gives the blocks of a stream in the order of their sequence numbers, each once.
///
/// A missing block is waited for until more than `wait_blocks` later ones are there. A number far ahead (65,536 and
/// more) is a restart of the sender, and so are numbers that run on from each other behind what was given: two of them
/// further back than 64, or 32 within these, which copies sent again after a reconnection might be.
class BlockOrder {
 public:
  struct Given {
    monitor::StreamBlock block;
    std::uint64_t lost_before = 0;  ///< blocks missing between the last one given and this
    bool restarted = false;         ///< what was before this has nothing to do with it
  };

  /// Appends to `out` what is in order by now.
  void take(monitor::StreamBlock&& block, std::vector<Given>& out);
  /// Waits no longer for what is missing.
  void give_up(std::vector<Given>& out);
  [[nodiscard]] const OrderCounts& counts() const { return counts_; }

  static constexpr std::size_t wait_blocks = 4;  ///< a gap is given up where blocks waiting behind it > wait_blocks

 private:
  void give(monitor::StreamBlock&& block, std::uint64_t lost, bool restarted, std::vector<Given>& out);
  void give_waiting(std::size_t keep, std::vector<Given>& out);
  void restart(monitor::StreamBlock&& block, std::vector<Given>& out);
  void take_old(monitor::StreamBlock&& block, std::vector<Given>& out);

  bool started_ = false;
  std::uint64_t next_ = 0;    ///< number of the block to give
  std::uint64_t recent_ = 0;  ///< bit i: block next_ - 1 - i was given
  std::uint64_t old_ = 0, old_run_ = 0;
  std::map<std::uint64_t, monitor::StreamBlock> waiting_;
  OrderCounts counts_;
};

}  // namespace robomill::live
