#pragma once
#include <string>

#include "robomill/cell/check.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cell {

/// check.json
[[nodiscard]] const io::Schema<CellCheck>& check_table();
[[nodiscard]] std::string cell_check_json(const CellCheck& check);

}  // namespace robomill::cell
