#pragma once
#include <cstddef>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/block_model.hpp"

namespace robomill::process {

/// Of the blocks that cut those that a map has columns of: 400 at most, evenly.
[[nodiscard]] std::vector<std::size_t> map_columns(const std::vector<std::size_t>& cutting);

/// Stability margin over path and γ at the speeds that were chosen, else as programmed, one look a class.
/// @param choice  of the result's program; null: it has none
[[nodiscard]] GammaMap gamma_map(const DecideProblem& problem, const BlockModel& model,
                                 const decision::ProgramDecision* choice, const DecideResult& result,
                                 Progress& progress);

}  // namespace robomill::process
