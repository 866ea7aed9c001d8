#pragma once
#include "robomill/page/report.hpp"

namespace robomill::page {

/// A report with every section filled, for tests: the FRFs of a published robot with 2 % noise, lobes of a single-mode
/// formula. Nothing in it is a recommendation.
[[nodiscard]] Report sample_report();

}  // namespace robomill::page
