#pragma once
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

/// Adds to PlanResult::assumed what the stages that ran have assumed, and the job itself.
/// @param cell  that the job runs in; null: none
void gather_assumed(PlanResult& result, const cell::Cell* cell);

}  // namespace robomill::jobs
