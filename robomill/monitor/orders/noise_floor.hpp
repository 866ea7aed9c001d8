#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// The noise beneath the lines of a spectrum: the median power of each block of lines, by straight lines between the
/// blocks' middles. Where lines stand at every multiple of a frequency, a block of two of these holds few of them.
class NoiseFloor {
 public:
  static constexpr std::size_t least_block = 8;  ///< lines

  explicit NoiseFloor(std::size_t lines) : floor_(lines), sorted_(lines), median_(lines / least_block + 1) {}
  /// @param power  |X|², line by line, no more than were given to the constructor
  /// @param part  of a block's lines that stand below the one that is taken, as the median of noise: < 0.5 where lines
  /// fill much of it
  /// @return the floor at each line, valid until the next call
  std::span<const float> of(std::span<const float> power, std::size_t block_lines, double part = 0.5) noexcept;

 private:
  std::vector<float> floor_, sorted_, median_;
};

}  // namespace robomill::monitor
