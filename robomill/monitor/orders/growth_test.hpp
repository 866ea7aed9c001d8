#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/orders/residual_lines.hpp"

namespace robomill::monitor {

/// Tests a cut against its own past: whether the energy of a line that is no multiple of the teeth has grown by 10 dB
/// while that of the multiples has not. Energies are taken in cells of 10 Hz and summed over five of them, so that a
/// line may drift; the past is their mean with a memory of 1 s, of 5 s while something has grown by 5 dB, once
/// 0.4 s have been learnt.
class GrowthTest {
 public:
  static constexpr double cell_hz = 10.0;

  struct Verdict {
    double energy = 0.0;        ///< of the strongest line that has grown by 10 dB; 0: none
    double frequency_hz = 0.0;  ///< of its cell
  };
  /// Cells up to a frequency, and some to spare.
  [[nodiscard]] static std::size_t cells(double highest_hz) noexcept;
  GrowthTest(double highest_hz, double hop_s);
  /// Where the energies of a hop go: cells of cell_hz from 0 on, all 0.
  [[nodiscard]] std::span<double> begin() noexcept;
  /// @param synchronous  energy of the multiples of rotation
  [[nodiscard]] Verdict step(double synchronous) noexcept;
  /// After step(): the hop belongs to a stable cut.
  void learn() noexcept;
  void forget() noexcept { learnt_ = 0; }

 private:
  double hop_s_;
  std::vector<double> cells_, usual_;
  double synchronous_ = 0.0, usual_synchronous_ = 0.0;
  std::size_t learnt_ = 0;  // hops
  bool suspect_ = false;
};

/// Tests the strongest family of lines {±f_c + k f} against its own past: L > 3 times the mean of L, whose memory is
/// 2 s (10 s while this holds), once 0.25 s have been learnt, and L > 0.02 S and a tenth of the swing of S: growth so
/// far below the cut marks no part.
class FamilyGrowth {
 public:
  explicit FamilyGrowth(double hop_s) : hop_s_(hop_s) {}
  /// @param swing   of S in 0.3 s
  /// @param learns  false: the past stays as it is
  [[nodiscard]] bool step(const ResidualFamily& now, double swing, bool learns) noexcept;
  void forget() noexcept { learnt_ = 0; }

 private:
  double hop_s_;
  double usual_ = 0.0;
  std::size_t learnt_ = 0;  // hops
};

}  // namespace robomill::monitor
