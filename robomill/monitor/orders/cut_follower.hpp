#pragma once
#include <cstddef>
#include <vector>

#include "robomill/monitor/orders/residual_lines.hpp"
#include "robomill/monitor/orders/speed_posterior.hpp"

namespace robomill::monitor {

/// Follows whether the tool cuts at a known speed, by the synchronous energy S of the short window.
///
/// Known: from where the posterior is narrow (0.4 within 0.4 %) and the comb holds 0.35 of the energy, unless S is
/// below 3 % of the loudest cut of late, which is an idling spindle. Until S falls below a tenth of what it was, which
/// is the tool leaving (in chatter the whole does); or, without chatter, to 0.4 within 0.3 s and to less than half of
/// the whole, while the whole stays above half of what it was, which is another speed.
class CutFollower {
 public:
  explicit CutFollower(double hop_s);
  /// @param chatter  neither a speed nor an entry is taken up
  void step(const ResidualFamily& now, const SpeedPosterior& speed, bool chatter) noexcept;
  [[nodiscard]] bool known() const noexcept { return cut_ > 0.0; }
  /// The posterior is narrow and the comb holds its share, in this hop, of a cut or of an idling spindle.
  [[nodiscard]] bool locked() const noexcept { return locked_; }
  /// What explained the cut still does: half of S, and a tenth of the whole.
  [[nodiscard]] bool anchored(const ResidualFamily& now) const noexcept;
  /// The tool enters: the energy has grown by four in 0.3 s, 0.4 s ago or less, where no cut was known. So does what
  /// begins with the stream.
  [[nodiscard]] bool enters() const noexcept { return entry_hops_ > 0; }
  /// The speed was lost, or chatter has ended, within the last second.
  [[nodiscard]] bool unsettled() const noexcept { return unsettled_hops_ > 0; }
  /// A cut has been known since reset().
  [[nodiscard]] bool has_cut() const noexcept { return loudest_ > 0.0; }
  [[nodiscard]] double loudest() const noexcept { return loudest_; }  ///< S, slowly forgotten
  [[nodiscard]] double swing() const noexcept;                        ///< of S in 0.3 s
  [[nodiscard]] double speed_range() const noexcept;                  ///< in 0.3 s, of the fastest
  [[nodiscard]] bool steady() const noexcept;                         ///< the speed, to 0.8 % in 0.3 s
  void chatter_ended() noexcept;
  /// The speed is not given any more.
  void forget_speed() noexcept { cut_ = 0.0; }
  void reset() noexcept;

 private:
  double hop_s_;
  std::vector<double> synchronous_, whole_, rotation_hz_;  // of the last 0.3 s; rings
  std::size_t at_ = 0;                                     // in these
  std::size_t entry_hops_ = 0, unsettled_hops_ = 0;
  bool locked_ = false;
  double cut_ = 0.0;  // S while the tool cuts at a known speed, slow; 0: it does not
  double loudest_ = 0.0;
};

}  // namespace robomill::monitor
