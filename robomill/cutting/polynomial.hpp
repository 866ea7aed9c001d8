#pragma once
#include <vector>

namespace robomill::cutting::detail {

/// Highest power first; none is 0.
inline double polynomial(const std::vector<double>& entries, double x) {
  double value = 0.0;
  for (const double entry : entries) value = value * x + entry;
  return value;
}

}  // namespace robomill::cutting::detail
