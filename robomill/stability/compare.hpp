#pragma once
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "All methods on one picture"

namespace robomill::stability {

/// What one method makes of the limits, beside the reference.
struct MethodRow {
  Method method = Method::collocation;
  std::vector<Limit> limits;  ///< one a speed; empty where the method rejects the problem
  std::string rejection;      ///< why, where it does
  /// Over the speeds at which this method and the reference both find a limit: |limit / reference - 1|. NaN where there
  /// are none.
  double median_error = 0.0, worst_error = 0.0;
  int differ = 0;  ///< speeds at which only one of the two finds a limit
  double seconds = 0.0;
};

struct MethodComparison {
  std::vector<double> spindle_speed_rad_per_s;
  std::vector<MethodRow> rows;  ///< the reference first: collocation, or multi-frequency for measured FRFs
};

/// The limits at evenly spaced speeds of the options' range, by every method that there is.
/// @param speeds  how many, at least 2
/// @throws InvalidInput if the problem or an option is out of range; Interrupted
[[nodiscard]] ROBOMILL_API MethodComparison compare_methods(const LobesProblem& problem, const LobesOptions& options,
                                                            int speeds, Progress& progress = Progress::none());

}  // namespace robomill::stability
