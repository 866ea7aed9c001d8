#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "robomill/path/sample.hpp"

namespace robomill::process {

/// How long a trajectory is in each block.
class BlockTimes {
 public:
  /// @param block_of  of each block that samples name the one that it counts to
  explicit BlockTimes(std::vector<std::size_t> block_of);
  /// In order of time; a sample at time 0 begins anew.
  void add(std::span<const path::Sample> samples);
  /// Up to the last block that samples may name.
  [[nodiscard]] const std::vector<double>& times_s() const { return times_s_; }

 private:
  std::vector<std::size_t> block_of_;
  std::optional<double> last_s_ = {};
  std::vector<double> times_s_ = {};
};

}  // namespace robomill::process
