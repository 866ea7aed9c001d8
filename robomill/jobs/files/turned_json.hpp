#pragma once
#include "robomill/io/json.hpp"
#include "robomill/jobs/turned.hpp"

namespace robomill::jobs {

/// {"blocks": blocks.json, "lost": […], "gamma": {…}, "unstable", "least_margin", "worst_block", "notes"}: blocks by
/// number from 1, mm and degrees.
[[nodiscard]] io::Json turned_object(const TurnedProgram& turned);

}  // namespace robomill::jobs
