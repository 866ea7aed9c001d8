#pragma once
#include "robomill/report/forces.hpp"

namespace robomill::report {

/// Forces of a ball-end cutter from the simplest formulas, along an invented spiral, for tests of the page. Nothing in
/// it is a prediction.
[[nodiscard]] Forces sample_forces();

}  // namespace robomill::report
