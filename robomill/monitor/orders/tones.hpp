#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace robomill::monitor {

/// The tones of a machine and of a room: what stood in cells of a spectrum before. Their mean with a memory of 1 s.
class Tones {
 public:
  Tones(std::size_t cells, double hop_s) : hop_s_(hop_s), usual_(cells) {}
  /// A hop in air, or in a cut that is surely stable.
  /// @param energy  of each cell
  void learn(std::span<const double> energy) noexcept;
  /// Whether what stands at a cell now, with two to each side, is less than four times what stood there. Before 0.3 s
  /// have been learnt nothing stood anywhere.
  [[nodiscard]] bool stood(std::size_t cell, std::span<const double> energy) const noexcept;
  void reset() noexcept { learnt_ = 0; }

 private:
  double hop_s_;
  std::vector<double> usual_;
  std::size_t learnt_ = 0;  // hops
};

}  // namespace robomill::monitor
