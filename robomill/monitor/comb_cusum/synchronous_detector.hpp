#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/comb_cusum/comb.hpp"
#include "robomill/monitor/monitor.hpp"

namespace robomill::monitor {

/// Chatter at a multiple of rotation, which the comb takes off: a harmonic that is no multiple of the teeth, holds a
/// quarter of the power and has grown eightfold against its learnt value, beyond what tooth passing has grown, for six
/// hops. Half way between multiples of tooth passing it is period doubling. Nothing is allocated after construction.
class SynchronousDetector {
 public:
  static constexpr std::size_t hops = 6;
  /// @param teeth  at least 2; less: nothing can be derived from tooth passing
  SynchronousDetector(std::size_t max_harmonics, int teeth);

  /// Amplitudes of a hop, a comb a channel, against those that were learnt.
  /// @param power  of all channels;  @param known  the combs have had time to learn what is usual
  bool step(std::span<const Comb> combs, double power, bool known) noexcept;
  /// Counts anew, after step() said yes to what turned out to be another thing.
  void doubt() noexcept { standing_ = 0; }
  /// While it chatters: the power has fallen to a tenth of the greatest.
  bool falls(std::span<const Comb> combs) noexcept;
  [[nodiscard]] std::size_t harmonic() const noexcept { return harmonic_; }
  [[nodiscard]] SynchronousChatter kind() const noexcept;
  void reset() noexcept;

 private:
  std::size_t teeth_;
  std::vector<double> now_, learnt_;  // power of each harmonic
  std::size_t harmonic_ = 0, standing_ = 0;
  double greatest_ = 0.0;
};

}  // namespace robomill::monitor
