#pragma once
#include "robomill/io/json.hpp"
#include "robomill/process/turned.hpp"

namespace robomill::process {

/// {"blocks": blocks.json, "lost": […], "gamma": {…}, "unstable", "least_margin", "worst_block", "notes"}: blocks by
/// number from 1, mm and degrees.
[[nodiscard]] io::Json turned_object(const TurnedProgram& turned);

}  // namespace robomill::process
