#pragma once
#include "robomill/report/report.hpp"

namespace robomill::report {

/// A report with every section filled, for tests: the FRFs of a published robot with 2 % noise, lobes of a single-mode
/// formula. Nothing in it is a recommendation.
[[nodiscard]] Report sample_report();

}  // namespace robomill::report
