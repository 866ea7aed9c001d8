#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/smooth.hpp"

// Method: robomill/jobs/README.md, "Outputs"

namespace robomill::jobs {

/// A result in the lines that the command line prints, and that a report shows where no script runs. Texts out of files
/// are printable.
[[nodiscard]] ROBOMILL_API std::string summary(const PlanResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const ForcesResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const SmoothResult& result);

}  // namespace robomill::jobs
