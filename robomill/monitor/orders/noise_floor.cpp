#include "robomill/monitor/orders/noise_floor.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr std::size_t every_line_below = 64;  // lines of a block: of longer ones every other is enough

}  // namespace

std::span<const float> NoiseFloor::of(std::span<const float> power, std::size_t block_lines, double part) noexcept {
  const auto as_median = static_cast<float>(std::log(0.5) / std::log1p(-part));  // |X|² of noise: exponential
  const std::size_t blocks = std::max<std::size_t>(1, power.size() / std::max(block_lines, least_block));
  const auto edge = [&](std::size_t block) { return block * power.size() / blocks; };
  const std::size_t stride = power.size() / blocks < every_line_below ? 1 : 2;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::size_t count = 0;
    for (std::size_t i = edge(b); i < edge(b + 1); i += stride) sorted_[count++] = power[i];
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(count));
    std::nth_element(sorted_.begin(), middle, sorted_.begin() + static_cast<std::ptrdiff_t>(count));
    median_[b] = as_median * *middle;
  }
  const auto out = std::span(floor_).first(power.size());
  const auto middle_of = [&](std::size_t block) { return static_cast<float>(edge(block) + edge(block + 1)) / 2.0F; };
  std::fill(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(middle_of(0)), median_[0]);
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    const float from = middle_of(b);
    const float slope = (median_[b + 1] - median_[b]) / (middle_of(b + 1) - from);
    const auto end = static_cast<std::size_t>(middle_of(b + 1));
    for (auto i = static_cast<std::size_t>(from); i < end; ++i) {
      out[i] = median_[b] + slope * (static_cast<float>(i) - from);
    }
  }
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(middle_of(blocks - 1)), out.end(), median_[blocks - 1]);
  return out;
}

}  // namespace robomill::monitor
