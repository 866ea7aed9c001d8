#pragma once
#include <cstddef>

namespace robomill::monitor {

/// Tests the strongest line of a spectrum, of any order, for exponential growth. Chatter grows by the same factor each
/// hop until the tool leaves the cut in each wave; what enters a cut out of silence rises less and less. With E the
/// line's energy in the last window, T a hop and r = ln(E/E of the hop before):
///   r/T > 20/s for 0.1 s, and the last r > 0.6 of their mean,
/// at a frequency that stays to 20 Hz, while the line holds 0.3 of all energy. Then it stands for 0.2 s more, as long
/// as it holds that. An entry over an idling spindle's own lines grows so, too: low multiples are the caller's to
/// exclude.
class Runaway {
 public:
  explicit Runaway(double hop_s) noexcept;
  /// @param share  of all energy, that the line holds
  /// @return it grows so, or has of late
  bool step(double frequency_hz, double energy, double share) noexcept;
  void reset() noexcept { *this = Runaway(hop_s_); }

 private:
  double hop_s_;
  std::size_t enough_hops_, standing_hops_;
  double log_energy_ = 0.0, risen_ = 0.0;
  double frequency_hz_ = -1e9;
  std::size_t hops_ = 0;  // that it has risen for
  std::size_t left_ = 0;  // hops for which it still stands
};

}  // namespace robomill::monitor
