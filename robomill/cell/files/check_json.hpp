#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/cell/check.hpp"

// Method: robomill/cell/README.md, "Outputs"

namespace robomill::cell {

/// check.json: docs/formats.md.
[[nodiscard]] ROBOMILL_API std::string cell_check_json(const CellCheck& check);

}  // namespace robomill::cell
