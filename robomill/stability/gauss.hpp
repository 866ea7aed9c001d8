#pragma once
#include <cstddef>
#include <vector>

#include "robomill/base/gauss.hpp"

namespace robomill::stability::detail {

/// The polynomial that is 1 at node l and 0 at the others.
double lagrange(const std::vector<double>& node, std::size_t l, double x);

}  // namespace robomill::stability::detail
