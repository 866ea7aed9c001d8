#pragma once
#include <optional>

#include "robomill/base/progress.hpp"
#include "robomill/decision/program_decision.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/block_model.hpp"

namespace robomill::process {

/// The program's own speeds, feeds and γ as a choice, where they keep every limit over the window of its speeds; none
/// where they do not, or where the lines of a stretch have several speeds.
/// @throws Interrupted
[[nodiscard]] std::optional<decision::ProgramDecision> choice_as_it_is(const DecideProblem& problem,
                                                                       const BlockModel& model, Progress& progress);

}  // namespace robomill::process
