#include "robomill/live/block_order.hpp"

#include <utility>

namespace robomill::live {
namespace {

constexpr std::uint64_t far_ahead = 65'536;
constexpr std::uint64_t recent_blocks = 64;
constexpr std::uint64_t run_far_back = 2, run_near = 32;

}  // namespace

void BlockOrder::take(monitor::StreamBlock&& block, std::vector<Given>& out) {
  const std::uint64_t number = block.sequence;
  if (!started_) {
    give(std::move(block), 0, false, out);
    return;
  }
  if (number < next_) {
    take_old(std::move(block), out);
    return;
  }
  old_run_ = 0;
  if (number - next_ >= far_ahead) {
    restart(std::move(block), out);
    return;
  }
  if (waiting_.contains(number)) {
    ++counts_.doubled;
    return;
  }
  if (!waiting_.empty() && number < waiting_.rbegin()->first) ++counts_.reordered;
  waiting_.emplace(number, std::move(block));
  give_waiting(wait_blocks, out);
}

void BlockOrder::give_up(std::vector<Given>& out) {
  give_waiting(0, out);
}

/// Gives what follows on, and beyond a gap whatever is more than `keep`.
void BlockOrder::give_waiting(std::size_t keep, std::vector<Given>& out) {
  while (!waiting_.empty() && (waiting_.begin()->first == next_ || waiting_.size() > keep)) {
    auto first = waiting_.extract(waiting_.begin());
    const std::uint64_t lost = first.key() - next_;
    counts_.lost += lost;
    give(std::move(first.mapped()), lost, false, out);
  }
}

void BlockOrder::give(monitor::StreamBlock&& block, std::uint64_t lost, bool restarted, std::vector<Given>& out) {
  const std::uint64_t step = lost + 1;
  recent_ = (step < recent_blocks ? recent_ << step : 0) | 1U;
  next_ = block.sequence + 1;
  started_ = true;
  out.push_back({.block = std::move(block), .lost_before = lost, .restarted = restarted});
}

void BlockOrder::restart(monitor::StreamBlock&& block, std::vector<Given>& out) {
  give_waiting(0, out);
  ++counts_.restarts;
  recent_ = 0;
  old_run_ = 0;
  give(std::move(block), 0, true, out);
}

void BlockOrder::take_old(monitor::StreamBlock&& block, std::vector<Given>& out) {
  const std::uint64_t back = next_ - 1 - block.sequence;
  const bool near = back < recent_blocks;
  old_run_ = old_run_ > 0 && block.sequence == old_ + 1 ? old_run_ + 1 : 1;
  old_ = block.sequence;
  if (old_run_ >= (near ? run_near : run_far_back)) {
    restart(std::move(block), out);
    return;
  }
  if (near && ((recent_ >> back) & 1U) != 0) {
    ++counts_.doubled;
    return;
  }
  ++counts_.late;
}

}  // namespace robomill::live
