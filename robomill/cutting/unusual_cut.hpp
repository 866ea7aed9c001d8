#pragma once
#include <string>
#include <vector>

#include "robomill/cutting/material.hpp"

// Method: robomill/cutting/README.md, "Unusual cuts"

namespace robomill::cutting {

/// What no single value shows: a feed per tooth that is large for the cutter's diameter, and cutting speeds of which
/// none is usual. A value of 0 is not known, and is not compared.
/// @return a sentence each, for the user
[[nodiscard]] std::vector<std::string> unusual_cut(double diameter_m, double feed_per_tooth_m,
                                                   const FromTo& cutting_speed_m_per_s);

}  // namespace robomill::cutting
