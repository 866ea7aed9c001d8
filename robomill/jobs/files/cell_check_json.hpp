#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/jobs/cell_check.hpp"

// Method: robomill/jobs/README.md, "Outputs"

namespace robomill::jobs {

/// check.json: docs/formats.md.
[[nodiscard]] ROBOMILL_API std::string cell_check_json(const CellCheck& check);

}  // namespace robomill::jobs
