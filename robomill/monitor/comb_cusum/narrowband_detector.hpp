#pragma once
#include <cstddef>

namespace robomill::monitor {

/// Chatter that no baseline has to be learnt for: a line that stands alone. Let x be its share of the whole power P.
/// Where the comb is taken off: x > 0.15 in three hops that do not fall. Where it is not known: x > 0.4 while ln P
/// rises by 0.25 a hop, four hops in a row and by 2 in all, at a frequency that the cut itself cannot have; or,
/// wherever it is, five hops, by 4 in all and still by 0.5: what enters a cut rises less and less, chatter as fast as
/// before. A line at half of its greatest power rings off and is forgotten.
class NarrowbandDetector {
 public:
  struct Hop {
    std::size_t line = 0;         ///< the strongest; 0: none
    double share = 0.0;           ///< x
    double power = 0.0;           ///< P, > 0
    bool comb_known = false;      ///< the comb is taken off the lines
    bool falls = false;           ///< the power of all channels does
    bool may_be_the_cut = false;  ///< a multiple of rotation or tooth passing, as far as the speed is known
  };
  /// true: it is chatter.
  bool step(const Hop& hop) noexcept;
  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  [[nodiscard]] bool begun() const noexcept { return hops_ > 0; }
  void reset() noexcept { *this = {}; }

 private:
  std::size_t line_ = 0, hops_ = 0;
  bool comb_known_ = false;
  double log_power_ = 0.0, rise_ = 0.0, top_ = 0.0;
};

}  // namespace robomill::monitor
