#pragma once
#include "robomill/decision/finish.hpp"
#include "robomill/decision/recommend.hpp"
#include "robomill/decision/test_cuts.hpp"
#include "robomill/io/schema.hpp"

// What a job says of machine, surface and cuts made.

namespace robomill::decision {

/// [spindle], [safety], and of [tool] the length of its edges
[[nodiscard]] const io::Schema<MachineLimits>& spindle_table();
[[nodiscard]] const io::Schema<MachineLimits>& safety_table();
[[nodiscard]] const io::Schema<MachineLimits>& edges_table();
/// [finishing]
[[nodiscard]] const io::Schema<FinishLimits>& finishing_table();
/// [[cuts]]
[[nodiscard]] const io::Schema<TestCut>& test_cut_table();

}  // namespace robomill::decision
