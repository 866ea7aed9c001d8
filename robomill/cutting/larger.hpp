#pragma once
#include <cmath>

namespace robomill::cutting::detail {

/// The one of larger magnitude, with its sign; the first of equal ones. Peaks are folds by it.
[[nodiscard]] inline double larger(double a, double b) {
  return std::abs(b) > std::abs(a) ? b : a;
}

}  // namespace robomill::cutting::detail
