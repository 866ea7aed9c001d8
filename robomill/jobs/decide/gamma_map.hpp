#pragma once
#include "robomill/base/progress.hpp"
#include "robomill/jobs/decide.hpp"
#include "robomill/jobs/decide/block_model.hpp"

namespace robomill::jobs {

/// Stability margin over path and γ at the speeds that were chosen, else as programmed, one look a class.
/// @param choice  of the result's program; null: it has none
[[nodiscard]] GammaMap gamma_map(const DecideProblem& problem, const BlockModel& model,
                                 const decision::ProgramDecision* choice, const DecideResult& result,
                                 Progress& progress);

}  // namespace robomill::jobs
