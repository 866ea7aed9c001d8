#pragma once
#include "robomill/base/progress.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/block_model.hpp"

namespace robomill::process {

/// Moves the finishing passes of what was found by the deflection that is predicted, where every limit still holds.
void compensate_found(const DecideProblem& problem, const BlockModel& model, DecideResult& out, Progress& progress);

}  // namespace robomill::process
