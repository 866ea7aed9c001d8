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
  static constexpr double least_growth = 10.0;  ///< of the energy

  struct Verdict {
    double energy = 0.0;        ///< of the strongest line that has grown by 10 dB, or by 5 dB where none has; 0: none
    double growth = 0.0;        ///< of its energy, less that of the multiples
    double frequency_hz = 0.0;  ///< of its cell
  };
  /// Cells up to a frequency, and some to spare.
  [[nodiscard]] static std::size_t cells(double highest_hz) noexcept;
  GrowthTest(double highest_hz, double hop_s);
  /// Where the energies of a hop go: cells of cell_hz from 0 on, all 0.
  [[nodiscard]] std::span<double> begin() noexcept;
  /// @param synchronous  energy of the multiples of tooth passing
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

/// The past of the strongest family of lines {±f_c + k f}: the mean of L with a memory of 2 s, of 10 s while L stands
/// at five times of it.
class FamilyPast {
 public:
  static constexpr double family_growth = 5.0;

  explicit FamilyPast(double hop_s) : hop_s_(hop_s) {}
  /// L against its past; 0 until a fifth of a second has been learnt.
  [[nodiscard]] double growth(double family) const noexcept;
  /// The hop belongs to a stable cut, or to the air.
  void learn(double family) noexcept;
  void forget() noexcept { sum_ = weight_ = 0.0; }

 private:
  double hop_s_;
  double sum_ = 0.0, weight_ = 0.0;  // weight: 1 after a long time
};

}  // namespace robomill::monitor
