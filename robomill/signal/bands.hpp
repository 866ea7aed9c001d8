#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/signal/README.md, "Method"

namespace robomill::signal {

/// A curve over equal runs of time: the lowest and the highest value in each; NaN where there was none.
struct Band {
  Eigen::VectorXd low = {}, high = {};
};

/// Curves over runs of equal length, how many samples there will be unknown: a run grows twice as long when there are
/// too many. No peak is lost, and the memory does not grow with the samples.
class ROBOMILL_API Bands {
 public:
  /// @throws InvalidInput if either is 0
  Bands(std::size_t curves, std::size_t most_runs);
  void clear();
  /// @param values  one a curve; NaN: the curve has none here
  void add(std::span<const double> values);
  /// As many samples at which no curve has a value, however many they are.
  void skip(std::uint64_t samples);
  [[nodiscard]] Band band(std::size_t curve) const;
  /// Samples in a run.
  [[nodiscard]] std::size_t length() const { return length_; }

 private:
  void halve();
  /// Begins a run; two runs become one first where there is no room.
  void begin(std::span<const double> values);
  std::size_t curves_, most_;
  std::size_t length_ = 1;          ///< samples in a run
  std::size_t in_last_ = 0;         ///< … in the last one
  std::vector<double> low_, high_;  ///< run by run, a value a curve
  std::vector<double> none_;        ///< NaN for each curve
};

}  // namespace robomill::signal
