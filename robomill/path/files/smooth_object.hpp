#pragma once
#include <array>

#include "robomill/io/schema.hpp"
#include "robomill/path/files/smooth_json.hpp"

namespace robomill::path {

/// smooth.json, for a file of its own and for plan.json. @throws InvalidInput if there is no method
[[nodiscard]] io::Json smooth_object(const SmoothedProgram& smoothed);

[[nodiscard]] const io::Schema<SmoothedProgram>& smooth_table();

/// How a program's start was chosen: "posture" of smooth.json and of check.json's placements.
struct PostureView {
  const PostureChoice* choice = nullptr;
  int joints = 0;
  const std::array<bool, 6>* prismatic = nullptr;  ///< joints that are lengths
};
[[nodiscard]] const io::Schema<PostureView>& posture_table();

}  // namespace robomill::path
