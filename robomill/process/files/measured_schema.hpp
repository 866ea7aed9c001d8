#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/process/measured.hpp"

namespace robomill::process {

/// `measured` of forces.json.
[[nodiscard]] const io::Schema<MeasuredRevolution>& measured_table();

}  // namespace robomill::process
