#pragma once
#include <limits>
#include <string>

// Method: robomill/report/README.md, "Method"

namespace robomill::report {

/// "Not known", or "none in the range" where a member says so; null in the JSON.
inline constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// A row of two texts: "Cutter", "3 teeth, 12 mm".
struct Fact {
  std::string label, value;
};

}  // namespace robomill::report
