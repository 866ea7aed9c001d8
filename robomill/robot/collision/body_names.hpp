#pragma once
#include <string>
#include <vector>

#include "robomill/robot/collision.hpp"

namespace robomill::robot {

/// Names of what ToolGeometry describes.
inline constexpr const char *cutter_name = "cutter", *shank_name = "shank", *holder_name = "holder",
                            *spindle_name = "spindle";

/// The names of all bodies: those of the tool, also of a shank or holder that is not there, and those given.
[[nodiscard]] std::vector<std::string> body_names(const CellGeometry& geometry);

}  // namespace robomill::robot
