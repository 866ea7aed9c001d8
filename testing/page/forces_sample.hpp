#pragma once
#include <string>

namespace robomill::page {

/// forces.json of a ball end in an invented cut, over a revolution and along a program of 800 blocks, with a robot.
/// @param text  of facts, warnings and notes, where it is not empty
[[nodiscard]] std::string sample_forces(const std::string& text = {});

}  // namespace robomill::page
