#pragma once
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/path/record/motion_recorder.hpp"
#include "robomill/path/record/outline.hpp"

namespace robomill::path {

/// What is recorded of a smoothed program for a page alone.
struct MotionView {
  const ProgramOutline* outline = nullptr;
  const std::vector<Motion>* motions = nullptr;  ///< in the order of smooth.json's methods
};
[[nodiscard]] const io::Schema<MotionView>& motion_table();
/// @throws InvalidInput if a motion has not one path for each corner
[[nodiscard]] std::string motion_json(const ProgramOutline& outline, const std::vector<Motion>& motions);

}  // namespace robomill::path
