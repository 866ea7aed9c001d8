#pragma once
#include <string>
#include <vector>

#include "robomill/path/record/motion_recorder.hpp"
#include "robomill/path/record/outline.hpp"

namespace robomill::path {

/// What is recorded of a smoothed program for a page alone: its outline and each method's motion. docs/formats.md.
/// @param motions  in the order of smooth.json's methods
/// @throws InvalidInput if a motion has not one path for each corner
[[nodiscard]] std::string motion_json(const ProgramOutline& outline, const std::vector<Motion>& motions);

}  // namespace robomill::path
