#pragma once
#include <string>

#include "robomill/cell/check.hpp"

namespace robomill::cell {

/// check.json: docs/formats.md.
[[nodiscard]] std::string cell_check_json(const CellCheck& check);

}  // namespace robomill::cell
