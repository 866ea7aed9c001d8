#pragma once
#include <cstdint>
#include <random>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// Seeded random numbers with the same bits everywhere: std::mt19937_64 is specified to the bit, the standard
/// distributions are not, so uniform and normal are our own. Parallel work takes one stream an item.
class ROBOMILL_API Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);
  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] double uniform();
  /// Uniform in [low, high).
  [[nodiscard]] double uniform(double low, double high);
  /// Standard normal, by the polar method of Marsaglia.
  [[nodiscard]] double normal();
  /// Uniform in {0, …, n - 1}, without bias; n > 0.
  [[nodiscard]] std::uint64_t index(std::uint64_t n);

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace robomill
