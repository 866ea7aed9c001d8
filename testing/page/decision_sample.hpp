#pragma once
#include <string>

namespace robomill::page {

/// What plan.json says of the decision on the program of sample_blocks: its own numbers as programmed, invented ones as
/// decided. Nothing in it is a recommendation.
/// @param text  of reasons, limits and notes, where it is not empty
[[nodiscard]] std::string sample_decision(const std::string& text = {});

}  // namespace robomill::page
