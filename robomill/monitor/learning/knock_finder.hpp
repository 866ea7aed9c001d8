#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/monitor/machine.hpp"
#include "robomill/monitor/orders/cut_tests.hpp"

namespace robomill::monitor {

/// Finds knocks: hops of six times the usual energy, that of the median of a second, down to a third of it in 0.15 s.
class KnockFinder {
 public:
  KnockFinder(std::size_t cells, double hop_s);
  /// Another recording.
  void begin();
  /// A hop. @param level  its rms; @param cells  energies, as CutTests::show has them
  void add(double level, std::span<const double> cells, const CutTests::Shown& shown);
  [[nodiscard]] LearntKnocks found(double seconds) const;

 private:
  void measure(std::span<const double> cells, const CutTests::Shown& shown);

  std::size_t past_hops_, longest_hops_;
  std::vector<double> past_;                                   // energies of hops, the last second's
  std::vector<double> usual_;                                  // of the cells
  double peak_ = 0.0;                                          // of the knock that may be one; 0: none
  std::size_t since_ = 0;                                      // hops
  std::vector<double> strength_, frequency_hz_, decay_per_s_;  // of each
};

}  // namespace robomill::monitor
