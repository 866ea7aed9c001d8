#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// Finds the rotation where no speed is given, among 15 to 500 Hz. Evidence is gathered over the hops with a memory of
/// 1 s, by the share s(f) of the energy below 1.5 kHz that the multiples of f hold beyond chance. Half of f
/// explains all that f does: a candidate is credited 4 ln f, so that the greatest one wins whose multiples are there.
/// It is found where it beats all others, but its multiples and whole parts, by 4. It may be a multiple of the rotation
/// or a part of tooth passing.
class CombSearch {
 public:
  explicit CombSearch(double hop_s);
  /// @param power  |X|² of the long window, of all channels, line by line
  void observe(std::span<const float> power, const Spectrum& like) noexcept;
  [[nodiscard]] double rotation_hz() const noexcept { return found_hz_; }  ///< 0: none
  void reset() noexcept;

 private:
  double hop_s_;
  double found_hz_ = 0.0;
  std::vector<double> candidate_hz_, credit_, evidence_;
  std::vector<float> place_, held_, here_;  // in lines; at all multiples; at one
};

}  // namespace robomill::monitor
