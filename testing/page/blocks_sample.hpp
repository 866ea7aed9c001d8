#pragma once
#include <string>

namespace robomill::page {

/// blocks.json of an invented program over a dome, for the sample page: regimes side by side, unstable blocks, moves in
/// air. Nothing in it is a prediction.
/// @param text    of modes and notes, where it is not empty
/// @param passes  across the dome, each of 40 blocks that cut and two in air
[[nodiscard]] std::string sample_blocks(const std::string& text = {}, int passes = 16);

}  // namespace robomill::page
