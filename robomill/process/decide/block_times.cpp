#include "robomill/process/decide/block_times.hpp"

#include <algorithm>
#include <utility>

namespace robomill::process {

BlockTimes::BlockTimes(std::vector<std::size_t> block_of) : block_of_(std::move(block_of)) {
  if (!block_of_.empty()) times_s_.assign(std::ranges::max(block_of_) + 1, 0.0);
}

void BlockTimes::add(std::span<const path::Sample> samples) {
  for (const path::Sample& sample : samples) {
    if (sample.time_s == 0.0) {
      last_s_.reset();
      std::ranges::fill(times_s_, 0.0);
    }
    if (last_s_) times_s_[block_of_.at(sample.block)] += sample.time_s - *last_s_;
    last_s_ = sample.time_s;
  }
}

}  // namespace robomill::process
