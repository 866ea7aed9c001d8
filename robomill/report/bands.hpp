#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/report/band.hpp"

namespace robomill::report {

/// Curves over runs of equal length, how many samples there will be unknown: a run grows twice as long when there are
/// too many.
class Bands {
 public:
  Bands(std::size_t curves, std::size_t most_runs);
  void clear();
  /// @param values  one a curve
  void add(std::span<const double> values);
  [[nodiscard]] Band band(std::size_t curve) const;
  /// Samples in a run.
  [[nodiscard]] std::size_t length() const { return length_; }

 private:
  void halve();
  std::size_t curves_, most_;
  std::size_t length_ = 1;          ///< samples in a run
  std::size_t in_last_ = 0;         ///< … in the last one
  std::vector<double> low_, high_;  ///< run by run, a value a curve
};

}  // namespace robomill::report
